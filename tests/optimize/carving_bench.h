// tests/optimize/carving_bench.h - a board and random scratches for tests of what the machine is told.
#pragma once

#include <random>

#include "burin/scene/board.h"
#include "burin/scene/scratches.h"

namespace burin {

inline Board board_200x100() {
  Board board;
  board.size_mm = {200, 100};
  board.carve_min_mm = {10, 10};
  board.carve_max_mm = {190, 90};
  board.material.depth_um = 14;
  return board;
}

/// Scratches that begin in the rectangle and end up to `step_mm` away along each axis.
inline Scratches random_scratches(std::size_t count, unsigned seed, const Eigen::Vector2d& min_mm,
                                  const Eigen::Vector2d& max_mm, double step_mm) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> x(min_mm.x(), max_mm.x()), y(min_mm.y(), max_mm.y()), step(-step_mm, step_mm);
  Scratches s;
  for (std::size_t i = 0; i < count; ++i) {
    s.x0_mm.push_back(x(random)), s.y0_mm.push_back(y(random));
    s.x1_mm.push_back(s.x0_mm[i] + step(random)), s.y1_mm.push_back(s.y0_mm[i] + step(random));
  }
  return s;
}

}  // namespace burin
