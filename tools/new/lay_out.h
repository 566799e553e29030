// tools/new/lay_out.h - a new bench on paper: tags on the board, lamp and eyes before it, so that every groove glints
// and every tag is found. Frame: board, mm.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "burin/base/finding.h"
#include "burin/scene/board.h"
#include "tools/new/words.h"

namespace burin {

/// What a person said of a bench; what was left out is chosen.
struct BenchWishes {
  Eigen::Vector2d board_mm{200, 150};
  int views = 1;
  SaidCamera camera;
  SaidLamp lamp;
  double stand_mm = 0;  ///< how far eyes are from the board's middle; 0: chosen by the board's size
};

/// The bench that came of it.
struct LaidOutBench {
  Board board;
  Eigen::Vector3d lamp_mm{0, 0, 0};
  std::vector<Eigen::Vector3d> eyes_mm;  ///< from left to right, whole mm
  double stand_mm = 0;
  double tag_px = 0;              ///< the shortest side of a tag in any view's photo
  std::vector<Finding> findings;  ///< what falls short, and what would help
};

/// Lays a bench out. Throws Error for a board too small for tags, and for a lamp or a distance for which no groove can
/// glint all over the board, with the distance that would do.
LaidOutBench lay_out(const BenchWishes& wanted);

}  // namespace burin
