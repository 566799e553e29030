// tools/report/chart.h - curves as inline SVG that follows the page's colors, light and dark.
#pragma once

#include <span>
#include <string>
#include <vector>

namespace burin {

/// Values at 0, 1, 2, ...; what is not finite is left out.
struct Curve {
  std::string name;
  std::vector<double> values;
  bool dashed = false;  ///< drawn with dashes, its marks hollow
  int color = -1;       ///< of six; -1: its place among the curves
};

struct ChartWords {
  std::string x_label, y_label;        ///< text
  std::string description;             ///< text: what it shows, for who cannot see it
  std::vector<std::string> x_names{};  ///< of 0, 1, 2, ...; empty: 0 and the last are numbered
  bool marks = false;                  ///< a mark at every value
  std::string of_dashed{};  ///< HTML: what dashed curves are; they then have no entry of their own in the legend
};

/// As a figure with its legend. Logarithmic in y where all values are positive and span a decade, unless `marks`.
/// Empty where nothing is finite.
std::string chart(std::span<const Curve> curves, const ChartWords& words);

}  // namespace burin
