#include "burin/optimize/carving/face.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace burin {
namespace {

// Appends the bends of the way from `from` to `to` (fractions of a to b), its end included.
void add_bends(const Face& face, const Eigen::Vector2d& a, const Eigen::Vector2d& b, double from, double to,
               double tolerance_mm, int halvings, std::vector<double>& out) {
  constexpr int kLooks = 8;
  const auto height = [&](double t) { return height_mm(face, a + t * (b - a)); };
  const double first = height(from), last = height(to);
  double worst = 0;
  for (int k = 1; k < kLooks && halvings > 0; ++k) {
    const double f = static_cast<double>(k) / kLooks;
    worst = std::max(worst, std::abs(height(from + f * (to - from)) - (first + f * (last - first))));
  }
  if (worst <= tolerance_mm) {
    out.push_back(to);
    return;
  }
  const double middle = (from + to) / 2;
  add_bends(face, a, b, from, middle, tolerance_mm, halvings - 1, out);
  add_bends(face, a, b, middle, to, tolerance_mm, halvings - 1, out);
}

}  // namespace

double height_mm(const Face& face, const Eigen::Vector2d& p_mm) {
  if (face.map) return height_mm(*face.map, p_mm);
  if (!face.bow) return 0;
  const auto bowed = [&](const Eigen::Vector2d& p) {
    const Eigen::Vector2d q = face.carves * p.homogeneous();
    return height_mm(*face.bow, q.x(), q.y());
  };
  return bowed(p_mm) - bowed(face.zero_mm);
}

std::vector<double> bends(const Face& face, const Eigen::Vector2d& a, const Eigen::Vector2d& b, double tolerance_mm) {
  constexpr int kMostHalvings = 8;
  std::vector<double> out;
  if (!face.followed())
    out.push_back(1);
  else
    add_bends(face, a, b, 0, 1, tolerance_mm, kMostHalvings, out);
  return out;
}

double range_mm(const Surface& bow, const Eigen::Vector2d& min_mm, const Eigen::Vector2d& max_mm) {
  constexpr int kPoints = 33;
  double low = INFINITY, high = -INFINITY;
  for (int j = 0; j < kPoints; ++j)
    for (int i = 0; i < kPoints; ++i) {
      const Eigen::Vector2d f(i / (kPoints - 1.0), j / (kPoints - 1.0));
      const Eigen::Vector2d p = min_mm + f.cwiseProduct(max_mm - min_mm);
      const double z = height_mm(bow, p.x(), p.y());
      low = std::min(low, z);
      high = std::max(high, z);
    }
  return high - low;
}

}  // namespace burin
