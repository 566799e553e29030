#include "burin/calib/light/probe/mirror_ball.h"

#include <Eigen/Geometry>
#include <cmath>

namespace burin {

Eigen::Vector3d TangentCone::ray(double angle, double turn) const {
  return std::cos(angle) * axis + std::sin(angle) * (std::cos(turn) * right + std::sin(turn) * up);
}

std::optional<TangentCone> tangent_cone(const MirrorBall& ball, const Eigen::Vector3d& eye_mm) {
  const Eigen::Vector3d to = ball.center_mm - eye_mm;
  const double distance = to.norm();
  if (!(distance > ball.radius_mm * (1 + 1e-9))) return std::nullopt;
  TangentCone cone;
  cone.axis = to / distance;
  // Any two directions across: the axis with the smallest component conditions them well.
  Eigen::Index least = 0;
  cone.axis.cwiseAbs().minCoeff(&least);
  cone.right = cone.axis.cross(Eigen::Vector3d::Unit(least)).normalized();
  cone.up = cone.axis.cross(cone.right);
  cone.half_angle = std::asin(ball.radius_mm / distance);
  return cone;
}

std::optional<Eigen::Vector3d> mirror_normal(const MirrorBall& ball, const Eigen::Vector3d& eye_mm,
                                             const Eigen::Vector3d& to_light) {
  const Eigen::Vector3d from_center = eye_mm - ball.center_mm;
  Eigen::Vector3d normal = to_light + from_center.normalized();
  if (!(normal.norm() > 1e-6)) return std::nullopt;
  normal.normalize();
  // The eye is near: iterate on the direction to it from the surface. Each step multiplies the error by radius over
  // distance.
  constexpr int kMostSteps = 60;
  constexpr double kSettled = 1e-10;
  for (int step = 0; step < kMostSteps; ++step) {
    const Eigen::Vector3d half = to_light + (from_center - ball.radius_mm * normal).normalized();
    if (!(half.norm() > 1e-6)) return std::nullopt;
    const Eigen::Vector3d next = half.normalized();
    const double moved = (next - normal).norm();
    normal = next;
    if (moved < kSettled) break;
  }
  if (!(normal.dot(to_light) > 0)) return std::nullopt;
  return normal;
}

}  // namespace burin
