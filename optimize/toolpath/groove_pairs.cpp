#include "burin/optimize/toolpath/groove_pairs.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace burin {
namespace {

constexpr int kMostCells = 4096;  // a side of the index

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

double side(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& p) {
  return cross(b - a, p - a);
}

double point_distance(const Eigen::Vector2d& p, const Groove& g) {
  const Eigen::Vector2d along = g.b_mm - g.a_mm;
  const double squared = along.squaredNorm();
  const double t = squared > 0 ? std::clamp((p - g.a_mm).dot(along) / squared, 0.0, 1.0) : 0;
  return (p - g.a_mm - t * along).norm();
}

bool on_line(const Groove& g, const Eigen::Vector2d& p) {
  return p.x() >= std::min(g.a_mm.x(), g.b_mm.x()) && p.x() <= std::max(g.a_mm.x(), g.b_mm.x()) &&
         p.y() >= std::min(g.a_mm.y(), g.b_mm.y()) && p.y() <= std::max(g.a_mm.y(), g.b_mm.y());
}

std::array<Eigen::Vector2d, 4> corners(const Groove& g) {
  const Eigen::Vector2d u = (g.b_mm - g.a_mm).normalized(), n = g.half_width_mm * Eigen::Vector2d(-u.y(), u.x());
  return {g.a_mm - n, g.b_mm - n, g.b_mm + n, g.a_mm + n};  // counter-clockwise
}

// True if p lies in a convex counter-clockwise polygon or, up to rounding, on its edge.
bool holds(const std::vector<Eigen::Vector2d>& polygon, const Eigen::Vector2d& p) {
  constexpr double kRounding_mm = 1e-9;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    if (side(a, b, p) < -kRounding_mm * (b - a).norm()) return false;
  }
  return true;
}

int count_at(const std::vector<std::vector<Eigen::Vector2d>>& parts, const Eigen::Vector2d& p) {
  return static_cast<int>(std::count_if(parts.begin(), parts.end(), [&](const auto& part) { return holds(part, p); }));
}

}  // namespace

bool lines_cross(const Groove& a, const Groove& b) {
  const double b_a = side(a.a_mm, a.b_mm, b.a_mm), b_b = side(a.a_mm, a.b_mm, b.b_mm);
  const double a_a = side(b.a_mm, b.b_mm, a.a_mm), a_b = side(b.a_mm, b.b_mm, a.b_mm);
  if (((b_a > 0 && b_b < 0) || (b_a < 0 && b_b > 0)) && ((a_a > 0 && a_b < 0) || (a_a < 0 && a_b > 0))) return true;
  return (b_a == 0 && on_line(a, b.a_mm)) || (b_b == 0 && on_line(a, b.b_mm)) || (a_a == 0 && on_line(b, a.a_mm)) ||
         (a_b == 0 && on_line(b, a.b_mm));
}

double line_distance_mm(const Groove& a, const Groove& b) {
  if (lines_cross(a, b)) return 0;
  return std::min(
      {point_distance(a.a_mm, b), point_distance(a.b_mm, b), point_distance(b.a_mm, a), point_distance(b.b_mm, a)});
}

std::vector<Eigen::Vector2d> common_part(const Groove& a, const Groove& b) {
  const auto corners_a = corners(a), corners_b = corners(b);
  std::vector<Eigen::Vector2d> polygon(corners_a.begin(), corners_a.end()), cut;
  // Clips at each of b's edges (Sutherland and Hodgman 1974).
  for (std::size_t e = 0; e < 4 && !polygon.empty(); ++e) {
    const Eigen::Vector2d &from = corners_b[e], &to = corners_b[(e + 1) % 4];
    cut.clear();
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Eigen::Vector2d &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
      const double at_p = side(from, to, p), at_q = side(from, to, q);
      if (at_p >= 0) cut.push_back(p);
      if ((at_p > 0 && at_q < 0) || (at_p < 0 && at_q > 0)) cut.emplace_back(p + at_p / (at_p - at_q) * (q - p));
    }
    polygon.swap(cut);
  }
  if (area_mm2(polygon) <= 0) polygon.clear();
  return polygon;
}

double area_mm2(const std::vector<Eigen::Vector2d>& polygon) {
  double twice = 0;
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i)
    twice += cross(polygon[i] - polygon[0], polygon[i + 1] - polygon[0]);
  return twice / 2;
}

int most_at_a_place(const std::vector<std::vector<Eigen::Vector2d>>& parts, int enough) {
  int most = 0;
  const auto look = [&](const Eigen::Vector2d& p) {
    most = std::max(most, count_at(parts, p));
    return most > enough;
  };
  for (const auto& part : parts)
    for (const Eigen::Vector2d& p : part)
      if (look(p)) return most;
  for (std::size_t i = 0; i < parts.size(); ++i)
    for (std::size_t j = i + 1; j < parts.size(); ++j)
      for (std::size_t k = 0; k < parts[i].size(); ++k)
        for (std::size_t l = 0; l < parts[j].size(); ++l) {
          const Eigen::Vector2d &a = parts[i][k], &c = parts[j][l];
          const Eigen::Vector2d ab = parts[i][(k + 1) % parts[i].size()] - a,
                                cd = parts[j][(l + 1) % parts[j].size()] - c;
          const double turn = cross(ab, cd);
          if (turn == 0) continue;
          const double t = cross(c - a, cd) / turn, u = cross(c - a, ab) / turn;
          if (t >= 0 && t <= 1 && u >= 0 && u <= 1 && look(a + t * ab)) return most;
        }
  return most;
}

GrooveIndex::GrooveIndex(const Eigen::Vector2d& min_mm, const Eigen::Vector2d& max_mm, double cell_mm)
    : min_mm_(min_mm), cell_mm_(std::max(cell_mm, (max_mm - min_mm).maxCoeff() / kMostCells)) {
  columns_ = std::max(1, static_cast<int>(std::ceil((max_mm.x() - min_mm.x()) / cell_mm_)));
  rows_ = std::max(1, static_cast<int>(std::ceil((max_mm.y() - min_mm.y()) / cell_mm_)));
  cells_.resize(static_cast<std::size_t>(columns_) * rows_);
}

template <typename Visit>
void GrooveIndex::cells_along(const Groove& groove, double reach_mm, const Visit& visit) const {
  const auto cell = [&](double at, double origin, int count) {
    return static_cast<int>(std::clamp(std::floor((at - origin) / cell_mm_), 0.0, count - 1.0));
  };
  Eigen::Vector2d a = groove.a_mm, b = groove.b_mm;
  if (a.x() > b.x()) std::swap(a, b);
  const int first = cell(a.x() - reach_mm, min_mm_.x(), columns_);
  const int last = cell(b.x() + reach_mm, min_mm_.x(), columns_);
  for (int c = first; c <= last; ++c) {
    // The line's heights over this column and a reach to both sides; the outermost columns reach to infinity.
    const double left = c == 0 ? a.x() : min_mm_.x() + c * cell_mm_ - reach_mm;
    const double right = c == columns_ - 1 ? b.x() : min_mm_.x() + (c + 1) * cell_mm_ + reach_mm;
    const auto height = [&](double x) {
      const double run = b.x() - a.x();
      return run > 0 ? a.y() + (b.y() - a.y()) * std::clamp((x - a.x()) / run, 0.0, 1.0) : a.y();
    };
    double low = height(left), high = height(right);
    if (b.x() - a.x() <= 0) high = b.y();
    if (low > high) std::swap(low, high);
    const int bottom = cell(low - reach_mm, min_mm_.y(), rows_), top = cell(high + reach_mm, min_mm_.y(), rows_);
    for (int r = bottom; r <= top; ++r) visit(static_cast<std::size_t>(c) * rows_ + r);
  }
}

void GrooveIndex::insert(std::uint32_t name, const Groove& groove) {
  cells_along(groove, 0, [&](std::size_t cell) { cells_[cell].push_back(name); });
}

std::size_t GrooveIndex::near_at_most(const Groove& groove, double reach_mm) const {
  std::size_t count = 0;
  cells_along(groove, reach_mm, [&](std::size_t cell) { count += cells_[cell].size(); });
  return count;
}

std::vector<std::uint32_t> GrooveIndex::near(const Groove& groove, double reach_mm) const {
  std::vector<std::uint32_t> names;
  cells_along(groove, reach_mm,
              [&](std::size_t cell) { names.insert(names.end(), cells_[cell].begin(), cells_[cell].end()); });
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return names;
}

}  // namespace burin
