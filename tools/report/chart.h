// tools/report/chart.h - curves as inline SVG in the page's colors, light and dark.
#pragma once

#include <span>
#include <string>
#include <vector>

namespace burin {

/// Values at 0, 1, 2, ...; NaN and infinity are left out.
struct Curve {
  std::string name;
  std::vector<double> values;
  bool dashed = false;  ///< dashed, with hollow marks
  int color = -1;       ///< one of six; -1: the curve's index
};

struct ChartWords {
  std::string x_label, y_label;        ///< text
  std::string description;             ///< text: alternative description of the chart
  std::vector<std::string> x_names{};  ///< of 0, 1, 2, ...; empty: 0 and the last are numbered
  bool marks = false;                  ///< a mark at every value
  std::string of_dashed{};  ///< HTML: meaning of dashed curves; they then have no entry of their own in the legend
};

/// Returns a figure with its legend. The y axis is logarithmic if all values are positive and span a decade, unless
/// `marks`. Returns an empty string without finite values.
std::string chart(std::span<const Curve> curves, const ChartWords& words);

}  // namespace burin
