#include "burin/calib/photo/stray_light.h"

#include <algorithm>
#include <cmath>

namespace burin {
namespace {

enum : int { kSlopeX, kSlopeY, kNearness, kLight, kSpread2 };

Eigen::Vector3d middle_of(const Eigen::Vector2d& board_size_mm) {
  return {0.5 * board_size_mm.x(), 0.5 * board_size_mm.y(), 0};
}

}  // namespace

Light stray_light(const StrayNumbers& numbers, const Eigen::Vector2d& board_size_mm) {
  const Eigen::Vector3d towards = Eigen::Vector3d(numbers[kSlopeX], numbers[kSlopeY], 1).normalized();
  const double distance_mm = board_size_mm.norm() / numbers[kNearness];
  Light out;
  out.id = "stray";
  out.position_mm = middle_of(board_size_mm) + distance_mm * towards;
  out.axis = -towards;
  out.intensity.setConstant(numbers[kLight] * distance_mm * distance_mm);
  out.size.disk_mm = distance_mm * std::sqrt(std::max(0.0, numbers[kSpread2]));
  return out;
}

Light stray_light(const Unknowns& x, const Eigen::Vector2d& board_size_mm) {
  StrayNumbers numbers;
  std::copy_n(x.data() + unknown::stray, kStrayNumbers, numbers.begin());
  return stray_light(numbers, board_size_mm);
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
  const Eigen::Vector3d slopes(numbers[kSlopeX], numbers[kSlopeY], 1), towards = slopes.normalized();
  const double distance_mm = board_size_mm.norm() / numbers[kNearness];
  const Eigen::Matrix3d turn =
      distance_mm / slopes.norm() * (Eigen::Matrix3d::Identity() - towards * towards.transpose());
  out.block<3, 2>(0, kSlopeX) = turn.leftCols<2>();
  out.block<3, 1>(0, kNearness) = -distance_mm / numbers[kNearness] * towards;
  out(3, kNearness) = -2 / numbers[kNearness];
  out(3, kLight) = 1 / numbers[kLight];
  return out;
}

}  // namespace burin
