#include "burin/scene/keep_out.h"

#include <algorithm>
#include <cmath>

namespace burin {
namespace {

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

double distance_to_edge(const Eigen::Vector2d& p, const Eigen::Vector2d& c, const Eigen::Vector2d& d) {
  const Eigen::Vector2d edge = d - c;
  const double squared = edge.squaredNorm();
  const double t = squared > 0 ? std::clamp((p - c).dot(edge) / squared, 0.0, 1.0) : 0;
  return (p - c - t * edge).norm();
}

bool inside(const Eigen::Vector2d& p, const std::vector<Eigen::Vector2d>& polygon) {
  bool in = false;
  for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
    const Eigen::Vector2d &a = polygon[i], &b = polygon[j];
    if ((a.y() > p.y()) != (b.y() > p.y()) && p.x() < (b.x() - a.x()) * (p.y() - a.y()) / (b.y() - a.y()) + a.x())
      in = !in;
  }
  return in;
}

void add(std::vector<LinePart>& blocked, double from, double to) {
  from = std::max(from, 0.0);
  to = std::min(to, 1.0);
  if (from < to) blocked.emplace_back(from, to);
}

void block_disc(std::vector<LinePart>& blocked, const Eigen::Vector2d& a, const Eigen::Vector2d& along,
                const Eigen::Vector2d& center, double radius) {
  const double squared = along.squaredNorm(), middle = (center - a).dot(along) / squared;
  const double chord = radius * radius - (a + middle * along - center).squaredNorm();
  if (chord > 0) add(blocked, middle - std::sqrt(chord / squared), middle + std::sqrt(chord / squared));
}

// The strip within `radius` of the edge c d, between its ends.
void block_strip(std::vector<LinePart>& blocked, const Eigen::Vector2d& a, const Eigen::Vector2d& along,
                 const Eigen::Vector2d& c, const Eigen::Vector2d& d, double radius) {
  const double length = (d - c).norm();
  if (!(length > 0)) return;
  const Eigen::Vector2d u = (d - c) / length;
  double from = 0, to = 1;
  // Two slabs: 0 <= along the edge <= length and -radius <= across it <= radius.
  const auto slab = [&](double at, double speed, double low, double high) {
    if (speed == 0) {
      if (at <= low || at >= high) to = -1;
      return;
    }
    double t0 = (low - at) / speed, t1 = (high - at) / speed;
    if (t0 > t1) std::swap(t0, t1);
    from = std::max(from, t0);
    to = std::min(to, t1);
  };
  slab((a - c).dot(u), along.dot(u), 0, length);
  slab(cross(u, a - c), cross(u, along), -radius, radius);
  add(blocked, from, to);
}

// Parts of the line inside a polygon, between its crossings with the edges. A test of each part's middle decides.
void block_inside(std::vector<LinePart>& blocked, const Eigen::Vector2d& a, const Eigen::Vector2d& along,
                  const std::vector<Eigen::Vector2d>& polygon) {
  std::vector<double> cuts{0, 1};
  for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
    const Eigen::Vector2d edge = polygon[i] - polygon[j];
    const double turn = cross(along, edge);
    if (turn == 0) continue;
    const double t = cross(polygon[j] - a, edge) / turn;
    if (t > 0 && t < 1) cuts.push_back(t);
  }
  std::sort(cuts.begin(), cuts.end());
  for (std::size_t k = 0; k + 1 < cuts.size(); ++k)
    if (inside(a + (cuts[k] + cuts[k + 1]) / 2 * along, polygon)) add(blocked, cuts[k], cuts[k + 1]);
}

bool far_away(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const KeepOut& place, double clearance) {
  Eigen::Vector2d low = place.center_mm, high = low;
  double reach = clearance + place.radius_mm;
  if (!place.polygon_mm.empty()) {
    low = high = place.polygon_mm.front();
    reach = clearance;
    for (const Eigen::Vector2d& p : place.polygon_mm) {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
  }
  return (a.cwiseMax(b).array() <= low.array() - reach).any() || (a.cwiseMin(b).array() >= high.array() + reach).any();
}

}  // namespace

double distance_mm(const Eigen::Vector2d& p, const KeepOut& place) {
  if (place.polygon_mm.empty()) return std::max(0.0, (p - place.center_mm).norm() - place.radius_mm);
  if (inside(p, place.polygon_mm)) return 0;
  double nearest = INFINITY;
  for (std::size_t i = 0, j = place.polygon_mm.size() - 1; i < place.polygon_mm.size(); j = i++)
    nearest = std::min(nearest, distance_to_edge(p, place.polygon_mm[j], place.polygon_mm[i]));
  return nearest;
}

std::vector<LinePart> free_parts(const Eigen::Vector2d& a, const Eigen::Vector2d& b, std::span<const KeepOut> places,
                                 double clearance_mm) {
  const Eigen::Vector2d along = b - a;
  std::vector<LinePart> blocked;
  for (const KeepOut& place : places) {
    if (far_away(a, b, place, clearance_mm)) continue;
    if (!(along.squaredNorm() > 0)) {
      if (distance_mm(a, place) < clearance_mm) return {};
      continue;
    }
    if (place.polygon_mm.empty()) {
      block_disc(blocked, a, along, place.center_mm, place.radius_mm + clearance_mm);
      continue;
    }
    block_inside(blocked, a, along, place.polygon_mm);
    for (std::size_t i = 0, j = place.polygon_mm.size() - 1; i < place.polygon_mm.size(); j = i++) {
      block_disc(blocked, a, along, place.polygon_mm[i], clearance_mm);
      block_strip(blocked, a, along, place.polygon_mm[j], place.polygon_mm[i], clearance_mm);
    }
  }
  std::sort(blocked.begin(), blocked.end());
  std::vector<LinePart> free;
  double at = 0;
  for (const auto& [from, to] : blocked) {
    if (from > at) free.emplace_back(at, from);
    at = std::max(at, to);
  }
  if (at < 1) free.emplace_back(at, 1.0);
  return free;
}

}  // namespace burin
