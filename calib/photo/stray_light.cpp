#include "burin/calib/photo/stray_light.h"

#include <algorithm>
#include <cmath>

namespace burin {
namespace {

Eigen::Vector3d middle_of(const Eigen::Vector2d& board_size_mm) {
  return {0.5 * board_size_mm.x(), 0.5 * board_size_mm.y(), 0};
}

}  // namespace

Light stray_light(const StrayNumbers& numbers, const Eigen::Vector2d& board_size_mm) {
  const Eigen::Vector3d towards = Eigen::Vector3d(numbers[kStraySlopeX], numbers[kStraySlopeY], 1).normalized();
  const double distance_mm = board_size_mm.norm() / numbers[kStrayNearness];
  Light out;
  out.id = "stray";
  out.position_mm = middle_of(board_size_mm) + distance_mm * towards;
  out.axis = -towards;
  out.intensity.setConstant(numbers[kStrayIrradiance] * distance_mm * distance_mm);
  out.size.disk_mm = distance_mm * std::sqrt(std::max(0.0, numbers[kStraySpread2]));
  return out;
}

Light stray_light(const Unknowns& x, const Eigen::Vector2d& board_size_mm) {
  return stray_light(stray_numbers(x.data() + unknown::stray), board_size_mm);
}

StrayNumbers stray_numbers(const Light& light, const Eigen::Vector2d& board_size_mm) {
  const Eigen::Vector3d to = light.position_mm - middle_of(board_size_mm);
  const double distance_mm = to.norm();
  return {to.x() / to.z(), to.y() / to.z(), board_size_mm.norm() / distance_mm,
          light.intensity.mean() / (distance_mm * distance_mm), std::pow(light.size.disk_mm / distance_mm, 2)};
}

Eigen::Matrix<double, 4, kStrayNumbers> stray_slopes(const StrayNumbers& numbers,
                                                     const Eigen::Vector2d& board_size_mm) {
  Eigen::Matrix<double, 4, kStrayNumbers> out = Eigen::Matrix<double, 4, kStrayNumbers>::Zero();
  const Eigen::Vector3d slopes(numbers[kStraySlopeX], numbers[kStraySlopeY], 1), towards = slopes.normalized();
  const double distance_mm = board_size_mm.norm() / numbers[kStrayNearness];
  const Eigen::Matrix3d turn =
      distance_mm / slopes.norm() * (Eigen::Matrix3d::Identity() - towards * towards.transpose());
  out.block<3, 2>(0, kStraySlopeX) = turn.leftCols<2>();
  out.block<3, 1>(0, kStrayNearness) = -distance_mm / numbers[kStrayNearness] * towards;
  out(3, kStrayNearness) = -2 / numbers[kStrayNearness];
  out(3, kStrayIrradiance) = 1 / numbers[kStrayIrradiance];
  return out;
}

}  // namespace burin
