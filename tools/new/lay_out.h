// tools/new/lay_out.h - layout of a new bench: tags on the board, lamp and eyes in front of it. Every groove glints and
// every tag is detectable. Frame: board, mm.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "burin/base/finding.h"
#include "burin/scene/board.h"
#include "tools/new/words.h"

namespace burin {

/// The user's wishes; missing values are chosen.
struct BenchWishes {
  Eigen::Vector2d board_mm{200, 150};
  int views = 1;
  SaidCamera camera;
  SaidLamp lamp;
  double stand_mm = 0;  ///< distance of the eyes from the board's center; 0: chosen by the board's size
};

/// The resulting bench.
struct LaidOutBench {
  Board board;
  Eigen::Vector3d lamp_mm{0, 0, 0};
  std::vector<Eigen::Vector3d> eyes_mm;  ///< from left to right, whole mm
  double stand_mm = 0;
  double tag_px = 0;              ///< shortest side of a tag in any view's photo
  std::vector<Finding> findings;  ///< shortcomings and their remedies
};

/// Lays a bench out. Throws Error for a board too small for tags. Throws Error, with a suitable distance, for a lamp or
/// distance for which no groove can glint all over the board.
LaidOutBench lay_out(const BenchWishes& wanted);

}  // namespace burin
