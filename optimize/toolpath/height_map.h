// burin/optimize/toolpath/height_map.h - how high the face lies where a machine has probed it: `heights.json`.
//
// Frame: the machine's (burin/optimize/machine_profile.h), mm. Heights count from the face at `zero_mm`, where the
// machine's Z was set to zero. docs/file-formats.md.
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
  Eigen::Vector2d zero_mm{0, 0};  ///< the place whose height is 0
  double drift_mm = 0;            ///< height of that place when the probing was over
  std::filesystem::path log;      ///< where the heights come from

  /// Where point `i` lies.
  Eigen::Vector2d at(std::size_t i) const {
    const std::size_t row = i / columns, column = i % columns;
    return first_mm + Eigen::Vector2d(static_cast<double>(column), static_cast<double>(row)).cwiseProduct(step_mm);
  }
};

/// Height at a place; beyond the grid's edge its outermost cells go on.
double height_mm(const HeightMap& map, const Eigen::Vector2d& p_mm);

/// How far a place lies beyond the grid; 0 within.
double beyond_mm(const HeightMap& map, const Eigen::Vector2d& p_mm);

/// Highest less lowest point, mm, of those that were probed.
double range_mm(const HeightMap& map);

/// The quadratic surface that fits the probed points best, at each point of the grid (a tilted plane where there are
/// too few for that).
std::vector<double> smooth_heights(const HeightMap& map);

/// Gives the points that were not probed the smooth surface's height, corrected by what their neighbors leave over.
void fill_in(HeightMap& map);

/// Throws Error naming `name` for heights that no sheet on a machine has: its plane tilts, a point stands out of the
/// smooth face round it, or neighbors differ by a step (chips, dust, a contact that bounced, another file's numbers).
void fail_unless_plausible(const HeightMap& map, const std::string& name);

/// Reads `heights.json`. Throws Error naming file and field for anything missing, unknown or out of range, for
/// heights that are not plausible, and where the face at `zero_mm` does not lie at 0 or that place is beyond the grid.
HeightMap read_heights(const std::filesystem::path& file);

/// Writes `heights.json`, atomically.
void write_heights(const HeightMap& map, const std::filesystem::path& file);

}  // namespace burin
