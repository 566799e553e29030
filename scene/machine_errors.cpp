#include "burin/scene/machine_errors.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace burin {
namespace {

double turns(const MachineErrors& errors, const Eigen::Vector2d& p, int axis) {
  return 2 * std::numbers::pi * p[axis] / errors.screw_period_mm[axis];
}

Eigen::Vector2d uneven_part(const MachineErrors& errors, const Eigen::Vector2d& p) {
  Eigen::Vector2d out(0, 0);
  for (int axis = 0; axis < 2; ++axis) {
    const double a = errors.screw_sin_mm[axis], b = errors.screw_cos_mm[axis];
    if (a == 0 && b == 0) continue;
    const double turn = turns(errors, p, axis);
    out[axis] = a * std::sin(turn) + b * std::cos(turn);
  }
  return out;
}

Eigen::Vector2d lag(const MachineErrors& errors, const Eigen::Vector2d& way) {
  const auto sign = [](double v) { return v > 0 ? 1.0 : v < 0 ? -1.0 : 0.0; };
  return 0.5 * errors.backlash_mm.cwiseProduct(Eigen::Vector2d(sign(way.x()), sign(way.y())));
}

}  // namespace

Eigen::Vector2d MachineErrors::screw_mm() const {
  return (screw_sin_mm.cwiseAbs2() + screw_cos_mm.cwiseAbs2()).cwiseSqrt();
}

Eigen::Vector2d MachineErrors::screw_phase_deg() const {
  return Eigen::Vector2d(std::atan2(screw_cos_mm.x(), screw_sin_mm.x()),
                         std::atan2(screw_cos_mm.y(), screw_sin_mm.y())) *
         (180 / std::numbers::pi);
}

Eigen::Vector2d displaced(const MachineErrors& errors, const Eigen::Vector2d& told_mm, const Eigen::Vector2d& way) {
  return told_mm + uneven_part(errors, told_mm) - lag(errors, way);
}

Eigen::Vector2d told_for(const MachineErrors& errors, const Eigen::Vector2d& wanted_mm, const Eigen::Vector2d& way) {
  const Eigen::Vector2d even = wanted_mm + lag(errors, way);
  Eigen::Vector2d told = even;
  // The iteration contracts by the screw's slope, some hundredths: a dozen steps reach the last bit.
  constexpr int kSteps = 12;
  for (int i = 0; i < kSteps && errors.uneven(); ++i) told = even - uneven_part(errors, told);
  return told;
}

int pieces_for(const MachineErrors& errors, const Eigen::Vector2d& from_mm, const Eigen::Vector2d& to_mm) {
  if (!errors.uneven()) return 1;
  double periods = 0;
  for (int axis = 0; axis < 2; ++axis)
    if (errors.screw_sin_mm[axis] != 0 || errors.screw_cos_mm[axis] != 0)
      periods = std::max(periods, std::abs(to_mm[axis] - from_mm[axis]) / errors.screw_period_mm[axis]);
  constexpr double kPiecesPerPeriod = 8;
  constexpr int kMost = 4000;
  return static_cast<int>(std::clamp(std::ceil(kPiecesPerPeriod * periods), 1.0, static_cast<double>(kMost)));
}

}  // namespace burin
