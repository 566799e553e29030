// burin/calib/photo/board_tiles.h - divides the board into squares over which scores are summed. The sums' scatter
// shows correlated errors of neighboring pixels. docs/model.md 9, "Sigmas".
#pragma once

#include "burin/base/cell_grid.h"
#include "burin/scene/board.h"

namespace burin {

inline constexpr double kTileMm = 20;

/// Squares of `side_mm`; larger ones on a board of more than some two thirds of a meter. More squares there would take
/// memory and add no information.
inline CellGrid board_tiles(const Board& board, double side_mm = kTileMm) {
  constexpr double kMost = 1024;
  return cell_grid(board.size_mm, side_mm, kMost);
}

}  // namespace burin
