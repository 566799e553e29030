// burin/calib/photo/overlap.h - grooves that cut into each other: where scratches cross, only the one carved last is
// left. Frame: board, mm.
//
// The renderer adds what crossing scratches send (docs/model.md 5). On a carved board the later groove replaces the
// earlier one, so the earlier one is interrupted. Cutting its center line where later grooves cover it keeps the area
// that is left exactly for grooves that cross fully, at any angle, and is right on average for those that touch or
// overlap sideways.
#pragma once

#include <cstddef>
#include <vector>

#include "burin/render/scratches.h"

namespace burin {

/// The pieces of scratches that later ones leave, in carving order, and the scratch that each is a piece of.
struct VisiblePieces {
  Scratches pieces;                 ///< width, depth and alpha are those of the source where it carries them
  std::vector<std::size_t> source;  ///< pieces.size() entries
};

/// Cuts scratches by all later ones. Widths and depths come from the scratches, else from the two numbers given.
VisiblePieces visible_pieces(const Scratches& carved, double tool_width_um, double depth_um);

}  // namespace burin
