#include "burin/calib/light/lamp_area.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace burin {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

}  // namespace

LampArea lamp_area(const LampSize& size, double unit_mm) {
  if (size.disk_mm > 0) return {std::pow(size.disk_mm / unit_mm, 2)};
  const Eigen::Vector2d square = (size.panel_mm / unit_mm).cwiseAbs2() / 6;
  const double difference = square.x() - square.y(), twice = 2 * size.turn_deg * kDegree;
  return {square.sum(), {difference * std::cos(twice), difference * std::sin(twice)}};
}

LampSize lamp_size(const LampArea& area, double unit_mm, double distance_mm) {
  LampSize out;
  if (!(area.size2 > 0)) return out;
  constexpr double kLargest = 0.45, kLeastSides = 0.05;
  const double largest_mm = kLargest * distance_mm;
  const double difference = std::hypot(area.sides2[0], area.sides2[1]);
  if (difference == 0) {
    out.disk_mm = std::min(largest_mm, unit_mm * std::sqrt(area.size2));
    return out;
  }
  constexpr double kMostDifference = (1 - kLeastSides * kLeastSides) / (1 + kLeastSides * kLeastSides);
  const double kept = std::min(difference, kMostDifference * area.size2);
  out.panel_mm << std::sqrt(3 * (area.size2 + kept)), std::sqrt(3 * (area.size2 - kept));
  out.panel_mm = (unit_mm * out.panel_mm).cwiseMin(2 * largest_mm);
  out.turn_deg = 0.5 * std::atan2(area.sides2[1], area.sides2[0]) / kDegree;
  return out;
}

std::array<std::array<double, 3>, 3> panel_slopes(const LampArea& area, double unit_mm) {
  const double difference = std::hypot(area.sides2[0], area.sides2[1]);
  const double c = area.sides2[0] / difference, s = area.sides2[1] / difference;
  const double longer = unit_mm * std::sqrt(3 * (area.size2 + difference)),
               shorter = unit_mm * std::sqrt(3 * std::max(1e-6 * area.size2, area.size2 - difference));
  const double by_longer = 1.5 * unit_mm * unit_mm / longer, by_shorter = 1.5 * unit_mm * unit_mm / shorter;
  const double by_turn = 0.5 / difference / kDegree;
  return {{{by_longer, by_longer * c, by_longer * s},
           {by_shorter, -by_shorter * c, -by_shorter * s},
           {0, -by_turn * s, by_turn * c}}};
}

}  // namespace burin
