// burin/scene/line_cuts.h - straight lines over the board: the grid cells that they cross, and their intervals under
// grooves.
// Frame: board, mm.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

namespace burin {

/// Square cells over a rectangle of the board.
struct CellsOfLines {
  Eigen::Vector2d min_mm{0, 0};
  double cell_mm = 1;
  int columns = 1, rows = 1;

  CellsOfLines() = default;
  /// Square cells of `side_mm` over the rectangle from `low_mm` to `high_mm`.
  CellsOfLines(const Eigen::Vector2d& low_mm, const Eigen::Vector2d& high_mm, double side_mm)
      : min_mm(low_mm),
        cell_mm(side_mm),
        columns(static_cast<int>((high_mm.x() - low_mm.x()) / side_mm) + 1),
        rows(static_cast<int>((high_mm.y() - low_mm.y()) / side_mm) + 1) {}

  /// Number of cells.
  std::size_t size() const { return static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows); }

  /// Calls visit(cell) once for every cell within `margin_mm` of a line. Cells come row by row, between the line's
  /// entry into the row's margin and its exit. `way_mm` runs from the line's first end to its last.
  template <typename Visit>
  void each(const Eigen::Vector2d& first_mm, const Eigen::Vector2d& way_mm, double margin_mm,
            const Visit& visit) const {
    constexpr double kRounding = 1e-9;
    const double m = margin_mm + kRounding;
    const Eigen::Vector2d a = first_mm - min_mm, &d = way_mm;
    const auto index = [this](double offset, int count) {
      return std::clamp(static_cast<int>(std::floor(offset / cell_mm)), 0, count - 1);
    };
    const int last_row = index(std::max(a.y(), a.y() + d.y()) + m, rows);
    for (int row = index(std::min(a.y(), a.y() + d.y()) - m, rows); row <= last_row; ++row) {
      double from = 0, to = 1;
      if (std::abs(d.y()) > kRounding) {
        const double below = (row * cell_mm - m - a.y()) / d.y(), above = ((row + 1) * cell_mm + m - a.y()) / d.y();
        from = std::clamp(std::min(below, above), 0.0, 1.0);
        to = std::clamp(std::max(below, above), 0.0, 1.0);
      }
      const double x_from = a.x() + from * d.x(), x_to = a.x() + to * d.x();
      const int last_column = index(std::max(x_from, x_to) + m, columns);
      for (int column = index(std::min(x_from, x_to) - m, columns); column <= last_column; ++column)
        visit(static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(column));
    }
  }
};

/// Boundary of an interval: the scratch's own end, or the outline of another groove (lines along it, to its left and
/// right, and lines across its two ends).
enum class LineBoundary : std::uint8_t { own_end, side_minus, side_plus, first_end, last_end };

/// An interval of a line, mm from its first end, with the part of a groove's outline at each end. Empty if from >= to.
struct LineStretch {
  double from = 0, to = 0;
  LineBoundary from_boundary = LineBoundary::own_end, to_boundary = LineBoundary::own_end;

  /// True if the stretch has no length.
  bool is_empty() const { return !(from < to); }
};

/// Keeps the part of an interval with a + b t between `low` and `high`; t is the distance along the line.
inline void clip_stretch(LineStretch& stretch, double a, double b, double low, double high, LineBoundary at_low,
                         LineBoundary at_high) {
  constexpr double kParallel = 1e-12;
  if (std::abs(b) < kParallel) {
    if (a < low || a > high) stretch.to = stretch.from;
    return;
  }
  double enters = (low - a) / b, leaves = (high - a) / b;
  if (enters > leaves) {
    std::swap(enters, leaves);
    std::swap(at_low, at_high);
  }
  if (enters > stretch.from) stretch.from = enters, stretch.from_boundary = at_low;
  if (leaves < stretch.to) stretch.to = leaves, stretch.to_boundary = at_high;
}

/// A groove in the coordinates of a line: distance from the groove's middle line and position along the groove, at the
/// line's first end. The slopes are changes per millimeter of the line.
struct GrooveMet {
  double across = 0, along = 0, across_slope = 0, along_slope = 0, length_mm = 0;
};

/// `u` and `groove_u`: unit vectors along the line and the groove.
inline GrooveMet groove_met(const Eigen::Vector2d& first_mm, const Eigen::Vector2d& u, const Eigen::Vector2d& groove_mm,
                            const Eigen::Vector2d& groove_u, double groove_length_mm) {
  const Eigen::Vector2d from = first_mm - groove_mm, across(groove_u.y(), -groove_u.x());
  return {from.dot(across), from.dot(groove_u), u.dot(across), u.dot(groove_u), groove_length_mm};
}

/// The part of a line of this length within `reach_mm` of the groove's middle line.
inline LineStretch covered_stretch(const GrooveMet& met, double line_mm, double reach_mm) {
  using Boundary = LineBoundary;
  LineStretch out{.to = line_mm};
  clip_stretch(out, met.across, met.across_slope, -reach_mm, reach_mm, Boundary::side_minus, Boundary::side_plus);
  if (!out.is_empty())
    clip_stretch(out, met.along, met.along_slope, 0, met.length_mm, Boundary::first_end, Boundary::last_end);
  return out;
}

}  // namespace burin
