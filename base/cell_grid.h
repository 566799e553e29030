// burin/base/cell_grid.h - a grid of square cells over a board, for spatial lookup.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>

namespace burin {

/// Places in mm, in the board's frame. A place beyond the board's rim belongs to the nearest cell.
struct CellGrid {
  double cell_mm = 1;
  int columns = 1, rows = 1;

  int column(double x_mm) const { return index(x_mm, columns); }
  int row(double y_mm) const { return index(y_mm, rows); }
  std::size_t cell(int column, int row) const { return static_cast<std::size_t>(row) * columns + column; }
  std::size_t cells() const { return static_cast<std::size_t>(rows) * columns; }

 private:
  int index(double at_mm, int count) const {
    return static_cast<int>(std::clamp(std::floor(at_mm / cell_mm), 0.0, count - 1.0));
  }
};

/// Cells of `cell_mm`, or larger ones if more than about `most` would cover the board.
inline CellGrid cell_grid(const Eigen::Vector2d& size_mm, double cell_mm, double most = 4e6) {
  const double side = std::max({cell_mm, std::sqrt(size_mm.x() * size_mm.y() / most), size_mm.maxCoeff() / most});
  const auto count = [&](double mm) { return std::max(1, static_cast<int>(std::ceil(mm / side))); };
  return {side, count(size_mm.x()), count(size_mm.y())};
}

}  // namespace burin
