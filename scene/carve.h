// burin/scene/carve.h - from a design to the metal, and the gradient back. Frame: board, mm. docs/model.md 7.
//
// Scratches pass through three hands, and each has a type, so that none can be taken for another:
//
//   Designed   where grooves are wanted: what a design moves
//   Sent       what the machine is told (a tool path's `sent.csv`): the designed ones through the inverse of the
//              machine's measured map
//   Carved     grooves as they lie in the metal: what renderers take, and what photos show
//
// carve() is the only way from the first two to the third. It applies what a bench knows of its machine and its
// grooves: the machine's map, how depth and roughness vary over the board, the tool's wear along the carving order,
// what happens where grooves cross, and what is carved already. Rows are in carving order.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "burin/scene/bench.h"
#include "burin/scene/board.h"
#include "burin/scene/crossings.h"
#include "burin/scene/scratch_gradients.h"
#include "burin/scene/scratches.h"

namespace burin {

/// Where grooves are wanted, with the depth and roughness that they are to have where rows say so. Rows marked `carved`
/// are in the metal already, just as they stand here.
struct Designed {
  Scratches scratches;

  Designed() = default;
  /// Scratches as wanted.
  explicit Designed(Scratches rows) : scratches(std::move(rows)) {}
  /// How many there are.
  std::size_t size() const { return scratches.size(); }
};

/// What the machine is told. Depths and roughnesses that rows carry are those of a board of the material that
/// board.json believes in; rows marked `carved` are not carved again.
struct Sent {
  Scratches scratches;

  Sent() = default;
  /// Scratches as told.
  explicit Sent(Scratches rows) : scratches(std::move(rows)) {}
  /// How many there are.
  std::size_t size() const { return scratches.size(); }
};

/// Grooves as they lie in the metal. Columns that are empty are shared: the board's width, the bench's depth and alpha.
struct Carved {
  Scratches scratches;
  /// The row of the designed (or sent) scratch that each is a piece of, and where the piece begins and ends along it.
  /// Empty: one whole groove for each row, in order.
  std::vector<std::uint32_t> source;
  std::vector<PieceEnd> begin, end;
  /// What is left of each where they cut one another: then `scratches` are whole. Null: they are what is left.
  std::shared_ptr<const VisibleLanes> lanes;

  /// How many there are.
  std::size_t size() const { return scratches.size(); }
};

/// What to tell the machine of a bench so that grooves come to lie where they are wanted, as deep as they are wanted:
/// through the inverse of its measured map, depths and roughnesses back to the board's believed material. Backlash
/// and the screws' error are undone at both ends. Fields and wear are not compensated. Throws Error for a map that
/// cannot be inverted.
Sent compensated(const Designed& designed, const Bench& bench, const Board& board);

/// What the machine of this bench makes of what it was told. Of a board that is looked at in places: what of the
/// grooves lies in any of these boxes, and is cut by others there: into pieces, or where that is said in `lanes`.
struct CutInto {
  int steps = kCrossingSteps;  ///< of visible_pieces()
  int lanes = 0;               ///< of visible_lanes(); 0: pieces
  double cell_mm = 0.1;        ///< of visible_lanes()
};
Carved carve(const Sent& sent, const Bench& bench, const Board& board,
             std::span<const Eigen::AlignedBox2d> looked_at = {}, const CutInto& cut = {});

/// What becomes of a design whose tool path compensates this bench's map: carve(compensated(designed)), but for the
/// last bit. Where a bench has no fields and its grooves add, this is the design as it stands.
Carved carve(const Designed& designed, const Bench& bench, const Board& board);

/// Grooves that are known to lie so: measured under a microscope, or made by a test.
Carved in_metal(Scratches grooves);

/// dE/d(designed rows) from dE/d(carved rows) (docs/model.md 7.7, 7.8), `carved` being carve(designed, bench, board):
/// pieces of a scratch move with its ends and with the grooves that cut it; depths and roughnesses follow their fields
/// as a scratch moves (for that `by_carved` must hold derivatives by depth and alpha). Rows marked `carved` get
/// derivatives too; whoever moves the rows leaves those where they are. Crossings that come or go as scratches move
/// have no derivative.
ScratchGradients pull_back(const Carved& carved, const Designed& designed, const Bench& bench, const Board& board,
                           ScratchGradients by_carved);

}  // namespace burin
