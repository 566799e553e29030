// burin/optimize/toolpath/height_map.h - heights of the face, probed by a machine: `heights.json`.
//
// Frame: the machine's (burin/optimize/machine_profile.h), mm. Heights count from the face at `zero_mm`, the place of
// the machine's Z zero. docs/file-formats.md.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace burin {

/// A grid of heights, bilinear between its points.
struct HeightMap {
  Eigen::Vector2d first_mm{0, 0};  ///< lowest x and y
  Eigen::Vector2d step_mm{1, 1};
  int columns = 0, rows = 0;
  std::vector<double> z_mm;       ///< row by row, lowest y first
  std::vector<bool> probed;       ///< the others, under tags and keep-outs, are filled in from their neighborhood
  Eigen::Vector2d zero_mm{0, 0};  ///< place with height 0
  double drift_mm = 0;            ///< height of `zero_mm` after the probing
  std::filesystem::path log;      ///< source of the heights

  /// Place of point `i`.
  Eigen::Vector2d at(std::size_t i) const {
    const std::size_t row = i / columns, column = i % columns;
    return first_mm + Eigen::Vector2d(static_cast<double>(column), static_cast<double>(row)).cwiseProduct(step_mm);
  }
};

/// Height at a place; beyond the grid its outermost cells are extrapolated.
double height_mm(const HeightMap& map, const Eigen::Vector2d& p_mm);

/// Distance of a place from the grid; 0 within.
double beyond_mm(const HeightMap& map, const Eigen::Vector2d& p_mm);

/// Highest minus lowest probed point, mm.
double range_mm(const HeightMap& map);

/// The best quadratic surface through the probed points, at each point of the grid (a tilted plane with too few
/// points).
std::vector<double> smooth_heights(const HeightMap& map);

/// Sets points without a probe to the smooth surface's height, corrected by their neighbors' residuals.
void fill_in(HeightMap& map);

/// Throws Error naming `name` for implausible heights of a sheet on a machine. These are a tilted plane, a point off
/// the smooth face around it, and a step between neighbors. Causes are chips, dust, a bounced contact, or another
/// file's numbers.
void fail_unless_plausible(const HeightMap& map, const std::string& name);

/// Reads `heights.json`. Throws Error naming file and field for anything missing, unknown or out of range, and for
/// implausible heights. Also throws if the face at `zero_mm` is not at 0, or if `zero_mm` is beyond the grid.
HeightMap read_heights(const std::filesystem::path& file);

/// Writes `heights.json`, atomically.
void write_heights(const HeightMap& map, const std::filesystem::path& file);

}  // namespace burin
