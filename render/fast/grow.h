// burin/render/fast/grow.h - buffers that persist between iterations and grow with the number of pairs.
#pragma once

#include <cstddef>
#include <vector>

namespace burin {

/// Makes `buffer` at least `size` long. On reallocation it reserves twice as much, so growing scratches seldom need the
/// heap. The system supplies no memory for reserved but unused pages.
template <typename T>
void grow_to(std::vector<T>& buffer, std::size_t size) {
  if (buffer.size() >= size) return;
  if (buffer.capacity() < size) buffer.reserve(2 * size);
  buffer.resize(size);
}

}  // namespace burin
