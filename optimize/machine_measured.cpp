#include "burin/optimize/machine_measured.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace burin {
namespace {

// A row of one or several cells.
struct Pooled {
  double depth_um, weight, command, cells;

  double sigma_um() const { return 1 / std::sqrt(weight); }
};

Pooled together(const Pooled& a, const Pooled& b) {
  const double weight = a.weight + b.weight, cells = a.cells + b.cells;
  return {(a.weight * a.depth_um + b.weight * b.depth_um) / weight, weight,
          (a.cells * a.command + b.cells * b.command) / cells, cells};
}

}  // namespace

DepthTable measured_table(const MachineMeasured& measured) {
  std::vector<Pooled> rows;
  for (const MeasuredCell& cell : measured.cells)
    if (cell.depth_um && cell.depth_um->sigma > 0 && cell.feed_mm_min == measured.usual_feed_mm_min &&
        cell.spacing_mm == measured.usual_spacing_mm)
      rows.push_back({cell.depth_um->value, std::pow(cell.depth_um->sigma, -2), cell.command, 1});
  // The coupon's cells begin with the softest. A cell with a smaller depth than its predecessor is pooled with it.
  for (std::size_t i = 0; i + 1 < rows.size();) {
    const Pooled &a = rows[i], &b = rows[i + 1];
    if (b.depth_um > a.depth_um) {
      ++i;
      continue;
    }
    constexpr double kBeyondChance = 2;
    if (a.depth_um - b.depth_um > kBeyondChance * std::hypot(a.sigma_um(), b.sigma_um())) return {};
    rows[i] = together(a, b);
    rows.erase(rows.begin() + static_cast<std::ptrdiff_t>(i) + 1);
    if (i > 0) --i;
  }
  DepthTable out;
  if (rows.size() < 2) return out;
  for (const Pooled& row : rows) out.rows.push_back({row.depth_um, row.command, row.sigma_um()});
  return out;
}

}  // namespace burin
