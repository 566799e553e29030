// burin/optimize/toolpath/groove_pairs.h - geometry of groove pairs: distance, overlap, and the number of grooves at
// one place. Frame: any plane, mm.
//
// A groove is a rectangle of the face: its scratch, widened by the half-width w (burin/scene/groove.h) to both sides.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace burin {

struct Groove {
  Eigen::Vector2d a_mm, b_mm;
  double half_width_mm = 0;

  double area_mm2() const { return (b_mm - a_mm).norm() * 2 * half_width_mm; }
};

/// True if the two lines from end to end meet.
bool lines_cross(const Groove& a, const Groove& b);

/// Distance between the two lines from end to end; 0 if they cross.
double line_distance_mm(const Groove& a, const Groove& b);

/// Corners of the common part of both grooves, counter-clockwise; empty if there is none. Exact.
std::vector<Eigen::Vector2d> common_part(const Groove& a, const Groove& b);
double area_mm2(const std::vector<Eigen::Vector2d>& polygon);

/// The largest number of these convex parts at one place. Counting stops beyond `enough`. Touching parts share their
/// edges. Exact: one corner of the most covered place is a corner of a part or a crossing of two parts' edges.
int most_at_a_place(const std::vector<std::vector<Eigen::Vector2d>>& parts, int enough);

/// Finds grooves within a distance of another, by a grid of squares with the lines through each.
class GrooveIndex {
 public:
  /// Squares of this side over the rectangle; grooves beyond its edge belong to the squares along it.
  GrooveIndex(const Eigen::Vector2d& min_mm, const Eigen::Vector2d& max_mm, double cell_mm);

  void insert(std::uint32_t name, const Groove& groove);

  /// Upper bound of the number of names from near(), with multiples counted.
  std::size_t near_at_most(const Groove& groove, double reach_mm) const;

  /// Names of all inserted grooves whose lines are within `reach_mm` of this one's line (and of some others nearby),
  /// ascending, each once.
  std::vector<std::uint32_t> near(const Groove& groove, double reach_mm) const;

 private:
  template <typename Visit>
  void cells_along(const Groove& groove, double reach_mm, const Visit& visit) const;

  Eigen::Vector2d min_mm_;
  double cell_mm_;
  int columns_, rows_;
  std::vector<std::vector<std::uint32_t>> cells_;
};

}  // namespace burin
