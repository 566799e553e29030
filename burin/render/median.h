// burin/render/median.h - the one median of all rooms.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace burin {

/// The median of some values, the upper one of the middle two where their number is even; 0 for none. Reorders them.
template <typename T>
T median_in_place(std::vector<T>& values) {
  if (values.empty()) return T(0);
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// The same of a copy: move large ones in.
template <typename T>
T median_of(std::vector<T> values) {
  return median_in_place(values);
}

}  // namespace burin
