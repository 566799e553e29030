// burin/render/fast/grow.h - buffers that are kept from one iteration to the next and grow with what the scratches
// touch.
#pragma once

#include <cstddef>
#include <vector>

namespace burin {

/// Makes `buffer` at least `size` long. Whenever it must move it reserves twice as much, so that an iteration in which
/// scratches grow seldom goes to the heap; the system gives no memory for what is reserved but not yet used.
template <typename T>
void grow_to(std::vector<T>& buffer, std::size_t size) {
  if (buffer.size() >= size) return;
  if (buffer.capacity() < size) buffer.reserve(2 * size);
  buffer.resize(size);
}

}  // namespace burin
