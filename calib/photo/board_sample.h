// burin/calib/photo/board_sample.h - selects representative squares of a crowded board. Frame: board, mm. docs/model.md
// 9, 'Crowded boards'.
//
// Grooves that cut one another become many pieces: of 4,000 strokes 50 mm long on 240 mm, 120 others cut each groove. A
// photo of a million pieces takes seconds. Squares spread over the board show lamp, machine and grooves as the whole
// does, with fewer pixels.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "burin/scene/board.h"
#include "burin/scene/footprint_grid.h"
#include "burin/scene/scratches.h"

namespace burin {

struct BoardSample {
  std::vector<Eigen::AlignedBox2d> squares{};  ///< empty: all of the board
  /// The squares with the margin of their pixels' light: the region of carved grooves.
  std::vector<Eigen::AlignedBox2d> surroundings{};
  double pieces = 0;  ///< approximate number in all squares; 0 for a whole board

  bool is_whole() const { return squares.empty(); }
  bool holds(const Eigen::Vector2d& place_mm) const;
};

/// The largest squares with at most about `most_pieces` pieces in all: up to four either way, around the middles of the
/// grooves there. If they would be smaller than 6 mm, fewer are taken, but at least one. The whole board, if it has no
/// more pieces (expected_pieces()). Squares of a smaller sample are inside those of a larger one. `surroundings` stay
/// empty.
BoardSample sample_of(const Scratches& scratches, const Board& board, double most_pieces);

/// A sample's share of the carve area.
double share_of(const BoardSample& sample, const Board& board);

/// The grid with footprints only in a sample's surroundings.
FootprintGrid footprints_of(const BoardSample& sample, FootprintGrid grid);

}  // namespace burin
