// burin/calib/photo/board_tiles.h - the squares of the board that scores are summed over, so that their scatter tells
// errors of neighboring pixels that are alike. docs/model.md 9, "Sigmas".
#pragma once

#include "burin/base/cell_grid.h"
#include "burin/scene/board.h"

namespace burin {

inline constexpr double kTileMm = 20;

/// Squares of `side_mm`; larger ones on a board of more than some two thirds of a meter, where more would take memory
/// and tell nothing.
inline CellGrid board_tiles(const Board& board, double side_mm = kTileMm) {
  constexpr double kMost = 1024;
  return cell_grid(board.size_mm, side_mm, kMost);
}

}  // namespace burin
