// burin/optimize/loss/bands.h - an image's rows in parallel, with sums independent of the number of threads.
#pragma once

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>

namespace burin {

/// Rows per task, and the unit of fixed-order sums. The bands grow with the image, so their number stays small.
inline constexpr int kMostBands = 256;
inline int band_rows(int rows) { return std::max(16, (rows + kMostBands - 1) / kMostBands); }

/// Calls body(first_row, end_row) for fixed bands of rows, in parallel; returns the sum of the results, in order.
template <typename Body>
double sum_over_bands(int rows, const Body& body) {
  const int each = band_rows(rows), bands = (rows + each - 1) / each;
  std::array<double, kMostBands> parts;
  tbb::parallel_for(0, bands, [&](int band) { parts[band] = body(band * each, std::min(rows, (band + 1) * each)); });
  double sum = 0;
  for (int band = 0; band < bands; ++band) sum += parts[band];
  return sum;
}

/// Calls body(first_row, end_row) for fixed bands of rows, in parallel.
template <typename Body>
void for_bands(int rows, const Body& body) {
  sum_over_bands(rows, [&](int first, int end) {
    body(first, end);
    return 0.0;
  });
}

}  // namespace burin
