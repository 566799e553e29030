// burin/calib/light/probe/mirror_ball.h - a mirror ball as geometry: its outline from an eye, and where on it an eye
// sees a direction. docs/model.md 11. Frame: board, mm.
#pragma once

#include <Eigen/Core>
#include <optional>

namespace burin {

struct MirrorBall {
  Eigen::Vector3d center_mm{0, 0, 0};
  double radius_mm = 0;
};

/// The rays from an eye that touch a ball: all at one angle from its middle (model.md 11.1).
struct TangentCone {
  Eigen::Vector3d axis{0, 0, 1};  ///< unit, from the eye
  Eigen::Vector3d right{1, 0, 0}, up{0, 1, 0};
  double half_angle = 0;  ///< rad

  /// The ray (unit) at `angle` from the axis, `turn` about it.
  Eigen::Vector3d ray(double angle, double turn) const;
};
/// Nothing for an eye that is in the ball or touches it.
std::optional<TangentCone> tangent_cone(const MirrorBall& ball, const Eigen::Vector3d& eye_mm);

/// Where an eye sees light from far away in a mirror ball: the surface's normal there (model.md 11.2). Nothing where
/// the ball itself stands between: behind it as the eye sees it.
std::optional<Eigen::Vector3d> mirror_normal(const MirrorBall& ball, const Eigen::Vector3d& eye_mm,
                                             const Eigen::Vector3d& to_light);

}  // namespace burin
