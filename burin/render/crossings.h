// burin/render/crossings.h - grooves that cut into each other: where scratches cross, only the one carved last is left.
// Frame: board, mm. docs/model.md 7.6.
//
// The renderer adds what crossing scratches send. On a carved board the later groove replaces the earlier one, so the
// earlier one is interrupted. Cutting its center line where later grooves cover it keeps the area that is left exactly
// for grooves that cross fully, at any angle, and is right on average for those that touch or overlap sideways.
#pragma once

#include <cstdint>
#include <vector>

#include "burin/render/groove_profile.h"
#include "burin/render/scratches.h"

namespace burin {

/// What happens where grooves cross: their light and areas add, or only the groove carved last is left.
enum class Crossings { add, last };

/// Where a piece of a scratch begins or ends.
struct PieceEnd {
  /// What ends it there: the scratch's own end, or the outline of a later groove (its sides at -w and +w across it, and
  /// the lines across its two ends).
  enum class Boundary : std::uint8_t { own_end, side_minus, side_plus, first_end, last_end };
  double at = 0;  ///< along the scratch: 0 its first end, 1 its last
  Boundary boundary = Boundary::own_end;
  std::uint32_t cutter = 0;  ///< the row of that later groove
};

/// The pieces of scratches that later ones leave, in carving order.
struct VisiblePieces {
  Scratches pieces;                   ///< width, depth and alpha are those of the source where it carries them
  std::vector<std::uint32_t> source;  ///< the row that each is a piece of
  std::vector<PieceEnd> begin, end;   ///< of each
};

/// Cuts scratches by all later ones. Widths and depths come from the scratches, else from the two numbers given.
VisiblePieces visible_pieces(const Scratches& carved, double tool_width_um, double depth_um,
                             const GrooveProfile& profile = {});

}  // namespace burin
