// burin/optimize/toolpath/face.h - the face that a tool path follows: even, bowed as a bench was measured, or probed.
// Frame: the machine's, mm; z = 0 where the machine's Z was set to zero.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "burin/optimize/toolpath/height_map.h"
#include "burin/scene/surface.h"

namespace burin {

/// What is known of the face's height. With neither part it is even: height 0 everywhere.
struct Face {
  std::optional<HeightMap> map;  ///< probed, on the machine
  std::optional<Surface> bow;    ///< measured in photos, where the same sheet lies as it lay then
  Eigen::Matrix<double, 2, 3> carves = Eigen::Matrix<double, 2, 3>::Identity();  ///< machine's place -> board's
  Eigen::Vector2d zero_mm{0, 0};                                                 ///< whose height is 0

  /// Whether it is anything but even.
  bool followed() const { return map.has_value() || bow.has_value(); }
};

/// Height of the face at a place; the probed one where there are both.
double height_mm(const Face& face, const Eigen::Vector2d& p_mm);

/// Least and greatest height of a straight way above the face, mm: exact, since the face is looked at on each line of
/// the height map's grid that the way crosses, and where it is nearest and farthest between two of them.
struct HeightRange {
  double least_mm = 0, most_mm = 0;
};
HeightRange height_above(const Face& face, const Eigen::Vector3d& from_mm, const Eigen::Vector3d& to_mm);

/// Height of the face's highest place: of a probed one's points, of a bowed one's over the sheet; at least 0.
double highest_mm(const Face& face);

/// By which share of its depth a scratch may leave the depth that it is to have where a face is followed.
inline constexpr double kFollowShare = 0.1;
inline double depth_share(const Face& face) { return face.followed() ? kFollowShare : 0; }

/// Where a straight way along the face must bend so that it stays within `tolerance_mm` of the face's height: fractions
/// of the way from a to b, rising, the last one 1.
std::vector<double> bends(const Face& face, const Eigen::Vector2d& a, const Eigen::Vector2d& b, double tolerance_mm);

/// Highest less lowest place of a bowed face over a rectangle, mm.
double range_mm(const Surface& bow, const Eigen::Vector2d& min_mm, const Eigen::Vector2d& max_mm);

}  // namespace burin
