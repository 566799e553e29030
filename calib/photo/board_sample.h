// burin/calib/photo/board_sample.h - squares of a crowded board that stand for all of it. Frame: board, mm.
// docs/model.md 9, 'Crowded boards'.
//
// Grooves that are cut by one another are many pieces: of 4,000 strokes 50 mm long on 240 mm a groove is cut by 120
// others, and photos of a million pieces take seconds each. Squares spread over the board show lamp, machine and
// grooves as the whole does, with fewer pixels.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "burin/scene/board.h"
#include "burin/scene/footprint_grid.h"
#include "burin/scene/scratches.h"

namespace burin {

struct BoardSample {
  std::vector<Eigen::AlignedBox2d> squares{};  ///< none: all of the board
  /// The same with what around them still reaches their pixels: where grooves are carved.
  std::vector<Eigen::AlignedBox2d> surroundings{};
  double pieces = 0;  ///< about how many there are in all squares; of all of the board not told

  bool is_whole() const { return squares.empty(); }
  bool holds(const Eigen::Vector2d& place_mm) const;
};

/// The largest squares, up to four either way around the middles of what is carved there, that are cut into no more
/// than about `most_pieces`; where they would be smaller than 6 mm fewer of them, but one. All of the board if all of
/// it is cut into no more (expected_pieces()). Squares of a smaller sample lie within those of a larger one. Without
/// surroundings.
BoardSample sample_of(const Scratches& scratches, const Board& board, double most_pieces);

/// Of the carve area, what a sample looks at.
double share_of(const BoardSample& sample, const Board& board);

/// The grid with the footprints in a sample's surroundings alone.
FootprintGrid footprints_of(const BoardSample& sample, FootprintGrid grid);

}  // namespace burin
