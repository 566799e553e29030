// burin/base/median.h - the one median, how sure it is, and the one quantile of all rooms.
#pragma once

#include <algorithm>
#include <cmath>
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

/// A median and its standard error.
struct MedianAndError {
  double median = 0, sigma = 0;
};

/// The error is that of normal values whose scatter the median deviation tells: 1.4826 sqrt(pi / 2) = 1.86 times that,
/// over the root of their number. Zeros for none.
inline MedianAndError median_and_error(std::vector<double> values) {
  if (values.empty()) return {};
  const double median = median_in_place(values);
  for (double& v : values) v = std::abs(v - median);
  return {median, 1.86 * median_in_place(values) / std::sqrt(static_cast<double>(values.size()))};
}

/// The value that a share `q` (0 to 1) of some values lies below. Reorders them; there has to be one at least.
template <typename T>
T quantile_in_place(std::vector<T>& values, double q) {
  const auto nth = values.begin() + static_cast<std::ptrdiff_t>(q * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), nth, values.end());
  return *nth;
}

/// The same of a copy: move large ones in.
template <typename T>
T quantile_of(std::vector<T> values, double q) {
  return quantile_in_place(values, q);
}

}  // namespace burin
