// burin/optimize/toolpath/face.h - the face under a tool path: even, with a measured bow, or probed. Frame: the
// machine's, mm; z = 0 at the place of the machine's Z zero.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "burin/optimize/toolpath/height_map.h"
#include "burin/scene/surface.h"

namespace burin {

/// Known heights of the face. With neither part it is even: height 0 everywhere.
struct Face {
  std::optional<HeightMap> map;  ///< probed, on the machine
  std::optional<Surface> bow;    ///< measured in photos; valid if the sheet lies as it did then
  Eigen::Matrix<double, 2, 3> carves = Eigen::Matrix<double, 2, 3>::Identity();  ///< machine's place -> board's
  Eigen::Vector2d zero_mm{0, 0};                                                 ///< place with height 0

  /// True if the face is not even.
  bool followed() const { return map.has_value() || bow.has_value(); }
};

/// Height of the face at a place; the probed one if there are both.
double height_mm(const Face& face, const Eigen::Vector2d& p_mm);

/// Exact least and greatest height of a straight way above the face, mm. The extremes are evaluated at crossings with
/// the height map's grid lines, and at the stationary points between two crossings.
struct HeightRange {
  double least_mm = 0, most_mm = 0;
};
HeightRange height_above(const Face& face, const Eigen::Vector3d& from_mm, const Eigen::Vector3d& to_mm);

/// Height of the face's highest place: over the probed points, or over the sheet for a bow; at least 0.
double highest_mm(const Face& face);

/// Permitted deviation from a scratch's depth on a followed face, as a share of that depth.
inline constexpr double kFollowShare = 0.1;
inline double depth_share(const Face& face) { return face.followed() ? kFollowShare : 0; }

/// Bends of a straight way along the face for a deviation of at most `tolerance_mm` from the face's height: fractions
/// of the way from a to b, ascending, the last one 1.
std::vector<double> bends(const Face& face, const Eigen::Vector2d& a, const Eigen::Vector2d& b, double tolerance_mm);

/// Highest minus lowest place of a bowed face over a rectangle, mm.
double range_mm(const Surface& bow, const Eigen::Vector2d& min_mm, const Eigen::Vector2d& max_mm);

}  // namespace burin
