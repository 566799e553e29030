#include "burin/scene/look_at.h"

#include <cmath>
#include <numbers>

namespace burin {

Eigen::Isometry3d look_at(const Eigen::Vector3d& eye_mm, const Eigen::Vector3d& aim_mm, double roll_deg) {
  const Eigen::Vector3d z = (aim_mm - eye_mm).normalized();
  const Eigen::Vector3d level = z.cross(Eigen::Vector3d::UnitY()).normalized(), down = z.cross(level);
  const double c = std::cos(roll_deg * std::numbers::pi / 180), s = std::sin(roll_deg * std::numbers::pi / 180);
  Eigen::Matrix3d R;
  R.row(0) = c * level + s * down;
  R.row(1) = -s * level + c * down;
  R.row(2) = z;
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = R;
  T.translation() = -R * eye_mm;
  return T;
}

}  // namespace burin
