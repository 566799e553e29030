#include "burin/optimize/toolpath/face.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

namespace burin {
namespace {

// Appends the bends of the way from `from` to `to` (fractions of a to b), its end included.
void add_bends(const Face& face, const Eigen::Vector2d& a, const Eigen::Vector2d& b, double from, double to,
               double tolerance_mm, int halvings, std::vector<double>& out) {
  const auto on_face = [&](double t) -> Eigen::Vector3d {
    const Eigen::Vector2d p = a + t * (b - a);
    return {p.x(), p.y(), height_mm(face, p)};
  };
  const HeightRange off = height_above(face, on_face(from), on_face(to));
  if (halvings == 0 || std::max(off.most_mm, -off.least_mm) <= tolerance_mm) {
    out.push_back(to);
    return;
  }
  const double middle = (from + to) / 2;
  add_bends(face, a, b, from, middle, tolerance_mm, halvings - 1, out);
  add_bends(face, a, b, middle, to, tolerance_mm, halvings - 1, out);
}

// Crossings of a way from a to b with the inner lines of a map's grid, as fractions of it, with 0 first and 1 last.
// Between two of them the face's height along the way is a quadratic.
std::vector<double> grid_crossings(const Face& face, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  std::vector<double> cuts{0};
  if (face.map) {
    const HeightMap& map = *face.map;
    const Eigen::Vector2d g = (a - map.first_mm).cwiseQuotient(map.step_mm), along = (b - a).cwiseQuotient(map.step_mm);
    for (const auto& [axis, points] : {std::pair(0, map.columns), std::pair(1, map.rows)}) {
      const double low = std::min(g[axis], g[axis] + along[axis]), high = std::max(g[axis], g[axis] + along[axis]);
      const double last = std::min(std::floor(high), points - 2.0);
      for (double line = std::max(std::ceil(low), 1.0); line <= last; ++line)
        if (const double t = (line - g[axis]) / along[axis]; t > 0 && t < 1) cuts.push_back(t);
    }
    std::sort(cuts.begin(), cuts.end());
  }
  cuts.push_back(1);
  return cuts;
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

HeightRange height_above(const Face& face, const Eigen::Vector3d& from_mm, const Eigen::Vector3d& to_mm) {
  const Eigen::Vector3d along = to_mm - from_mm;
  const auto above = [&](double t) {
    const Eigen::Vector3d p = from_mm + t * along;
    return p.z() - height_mm(face, p.head<2>());
  };
  HeightRange range{above(0), above(0)};
  const auto look = [&](double mm) {
    range.least_mm = std::min(range.least_mm, mm);
    range.most_mm = std::max(range.most_mm, mm);
  };
  look(above(1));
  if (!face.followed()) return range;
  const std::vector<double> cuts = grid_crossings(face, from_mm.head<2>(), to_mm.head<2>());
  for (std::size_t k = 0; k + 1 < cuts.size(); ++k) {
    const double first = above(cuts[k]), middle = above((cuts[k] + cuts[k + 1]) / 2), last = above(cuts[k + 1]);
    look(last);
    // The quadratic through three values: a s^2 + b s + first, s from 0 to 1.
    const double a = 2 * (first - 2 * middle + last), b = last - first - a;
    if (const double turn = -b / (2 * a); a != 0 && turn > 0 && turn < 1) look(first + b * turn / 2);
  }
  return range;
}

double highest_mm(const Face& face) {
  double highest = 0;
  if (face.map) {
    for (const double z : face.map->z_mm) highest = std::max(highest, z);
  } else if (face.bow) {
    // Its terms are largest at the sheet's edge; their sum is an upper bound of the face.
    const Eigen::Vector2d q = face.carves * face.zero_mm.homogeneous();
    const double zero_mm = height_mm(*face.bow, q.x(), q.y());
    const Eigen::Vector3d& bow = face.bow->bow_mm;
    highest = std::max(0.0, std::max(bow[0], 0.0) + std::abs(bow[1]) + std::max(bow[2], 0.0) - zero_mm);
  }
  return highest;
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
