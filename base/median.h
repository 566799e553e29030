// burin/base/median.h - median with standard error, and quantile, for all libraries.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace burin {

/// The median of the values; the upper of the two middle ones for an even count; 0 for none. Reorders them.
template <typename T>
T median_in_place(std::vector<T>& values) {
  if (values.empty()) return T(0);
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// The median of a copy: move large vectors in.
template <typename T>
T median_of(std::vector<T> values) {
  return median_in_place(values);
}

/// A median and its standard error.
struct MedianAndError {
  double median = 0, sigma = 0;
};

/// The error assumes normal values with the scatter of the median absolute deviation (MAD): 1.4826 sqrt(pi / 2) = 1.86
/// times the MAD, divided by the root of their number. Zeros for none.
inline MedianAndError median_and_error(std::vector<double> values) {
  if (values.empty()) return {};
  const double median = median_in_place(values);
  for (double& v : values) v = std::abs(v - median);
  return {median, 1.86 * median_in_place(values) / std::sqrt(static_cast<double>(values.size()))};
}

/// The value above a fraction `q` (0 to 1) of the values. Reorders them; at least one is required.
template <typename T>
T quantile_in_place(std::vector<T>& values, double q) {
  const auto nth = values.begin() + static_cast<std::ptrdiff_t>(q * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), nth, values.end());
  return *nth;
}

/// The quantile of a copy: move large vectors in.
template <typename T>
T quantile_of(std::vector<T> values, double q) {
  return quantile_in_place(values, q);
}

}  // namespace burin
