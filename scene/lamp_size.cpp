#include "burin/scene/lamp_size.h"

#include <cmath>
#include <initializer_list>
#include <numbers>
#include <utility>

namespace burin {

Eigen::Matrix<double, 3, 2> across_axis(const Eigen::Vector3d& axis, double turn_deg) {
  constexpr double kAlongX = 0.999;
  const Eigen::Vector3d start = std::abs(axis.x()) < kAlongX ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitY();
  const Eigen::Vector3d u = (start - start.dot(axis) * axis).normalized(), v = axis.cross(u);
  const double turn = turn_deg * std::numbers::pi / 180;
  Eigen::Matrix<double, 3, 2> out;
  out << std::cos(turn) * u + std::sin(turn) * v, std::cos(turn) * v - std::sin(turn) * u;
  return out;
}

namespace {

struct Node {
  double at, share;
};

// Gauss-Legendre nodes on -1 to 1, with weights that add up to 1. `half` is half a side relative to the distance; it
// determines the number of nodes.
std::vector<Node> nodes_of_side(double half, bool few) {
  if (half < 0.04) return {{-std::sqrt(1. / 3), 0.5}, {std::sqrt(1. / 3), 0.5}};
  if (half < 0.075) return {{-std::sqrt(0.6), 5. / 18}, {0, 8. / 18}, {std::sqrt(0.6), 5. / 18}};
  const auto mirrored = [](std::initializer_list<Node> nodes) {
    std::vector<Node> out;
    for (const Node& n : nodes) {
      out.push_back({-n.at, n.share});
      out.push_back(n);
    }
    return out;
  };
  if (half < 0.15 || few) {
    const double root = 2 * std::sqrt(1.2), share = std::sqrt(30.) / 72;
    return mirrored({{std::sqrt((3 - root) / 7), 0.25 + share}, {std::sqrt((3 + root) / 7), 0.25 - share}});
  }
  return mirrored({{0.2386191860831969, 0.2339569672863456},
                   {0.6612093864662645, 0.1803807865240693},
                   {0.9324695142031521, 0.0856622461895851}});
}

// Adds points around the middle of a disk of radius 1.
void add_ring(int count, double radius, double share, double first_deg,
              std::vector<std::pair<Eigen::Vector2d, double>>& out) {
  for (int i = 0; i < count; ++i) {
    const double angle = (first_deg + 360.0 * i / count) * std::numbers::pi / 180;
    out.emplace_back(radius * Eigen::Vector2d(std::cos(angle), std::sin(angle)), share);
  }
}

}  // namespace

std::vector<LampPoint> lamp_points(const Light& light, bool few) {
  if (light.size.is_point()) return {{}};
  std::vector<LampPoint> out;
  const Eigen::Matrix<double, 3, 2> across = across_axis(light.axis, light.size.turn_deg);
  const double distance_mm = light.axis.z() < 0 ? -light.position_mm.z() / light.axis.z() : light.position_mm.norm();
  constexpr double kLarge = 0.04, kVeryLarge = 0.075;
  if (light.size.disk_mm > 0) {
    std::vector<std::pair<Eigen::Vector2d, double>> points;
    if (light.size.disk_mm > kVeryLarge * distance_mm) {
      // Gauss-Legendre nodes over the square of the radius, with rings rotated relative to each other.
      const double outer = std::sqrt(0.5 * (1 + std::sqrt(0.6))), inner = std::sqrt(0.5 * (1 - std::sqrt(0.6)));
      add_ring(8, inner, 5. / 144, 0, points);
      add_ring(8, std::sqrt(0.5), 8. / 144, 22.5, points);
      add_ring(8, outer, 5. / 144, 0, points);
    } else if (light.size.disk_mm > kLarge * distance_mm) {
      points.emplace_back(Eigen::Vector2d(0, 0), 0.25);
      add_ring(6, std::sqrt(2. / 3), 0.125, 0, points);
    } else {
      add_ring(4, std::sqrt(0.5), 0.25, 45, points);
    }
    for (const auto& [at, share] : points) out.push_back({across * (light.size.disk_mm * at), share});
    return out;
  }
  const Eigen::Vector2d half = 0.5 * light.size.panel_mm;
  for (const Node& x : nodes_of_side(half.x() / distance_mm, few))
    for (const Node& y : nodes_of_side(half.y() / distance_mm, few))
      out.push_back({across * Eigen::Vector2d(half.x() * x.at, half.y() * y.at), x.share * y.share});
  return out;
}

}  // namespace burin
