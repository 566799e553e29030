// burin/calib/light/probe/mirror_ball.h - the geometry of a mirror ball: its outline from an eye, and the point at
// which an eye sees a direction. docs/model.md 11. Frame: board, mm.
#pragma once

#include <Eigen/Core>
#include <optional>

namespace burin {

/// A mirror ball on the board, in the board's frame.
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
/// Empty for an eye inside the ball or on it.
std::optional<TangentCone> tangent_cone(const MirrorBall& ball, const Eigen::Vector3d& eye_mm);

/// The normal at the point of a mirror ball that reflects a distant light to an eye (model.md 11.2). Empty if the ball
/// itself hides the light: if the light is behind it for the eye.
std::optional<Eigen::Vector3d> mirror_normal(const MirrorBall& ball, const Eigen::Vector3d& eye_mm,
                                             const Eigen::Vector3d& to_light);

}  // namespace burin
