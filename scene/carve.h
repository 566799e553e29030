// burin/scene/carve.h - forward model from a design to the metal, and its backward pass. Frame: board, mm.
// docs/model.md 7.
//
// Scratches have one type for each of three stages, so the compiler prevents confusion:
//
//   Designed   desired positions: the variables of a design
//   Sent       commanded trajectory (a tool path's `sent.csv`): the designed positions through the inverse of the
//              affine machine calibration
//   Carved     grooves in the metal: the renderers' input, visible in photos
//
// carve() is the only way from the first two to the third. It applies the setup's affine map, variation of depth and
// roughness over the board, tool wear along the carving order, the crossing rule, and existing scratches. Rows are in
// carving order.
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

/// Desired positions, with desired depths and roughnesses if rows carry them. Rows marked `carved` are in the metal
/// already and stay fixed.
struct Designed {
  Scratches scratches;

  Designed() = default;
  /// Takes desired scratches.
  explicit Designed(Scratches rows) : scratches(std::move(rows)) {}
  /// Number of rows.
  std::size_t size() const { return scratches.size(); }
};

/// Commanded trajectory. Depths and roughnesses in rows refer to a board of board.json's prior material. The machine
/// skips rows marked `carved`.
struct Sent {
  Scratches scratches;

  Sent() = default;
  /// Takes commanded scratches.
  explicit Sent(Scratches rows) : scratches(std::move(rows)) {}
  /// Number of rows.
  std::size_t size() const { return scratches.size(); }
};

/// Grooves in the metal. Empty columns are shared: the board's width, the setup's depth and alpha.
struct Carved {
  Scratches scratches;
  /// The row of the designed (or sent) scratch of each piece, and the piece's ends along it. Empty: one whole groove
  /// per row, in order.
  std::vector<std::uint32_t> source;
  std::vector<PieceEnd> begin, end;
  /// Remaining parts of grooves that cut each other; `scratches` are then whole. Null: `scratches` are the remaining
  /// parts.
  std::shared_ptr<const VisibleLanes> lanes;

  /// Number of rows.
  std::size_t size() const { return scratches.size(); }
};

/// Computes the commanded trajectory that gives the desired positions and depths on a setup's machine. It applies the
/// inverse of the affine machine calibration and scales depths and roughnesses back to the board's prior material. It
/// compensates backlash and the screws' error at both ends, but neither fields nor wear. Throws Error for a map without
/// an inverse.
Sent compensated(const Designed& designed, const Bench& bench, const Board& board);

/// Carves the commanded trajectory on this setup's machine. `looked_at` restricts the result to the parts of grooves in
/// any of these boxes, after the cuts there: as pieces, or as `lanes`.
struct CutInto {
  int steps = kCrossingSteps;  ///< of visible_pieces()
  int lanes = 0;               ///< of visible_lanes(); 0: pieces
  double cell_mm = 0.05;       ///< of visible_lanes()
};
Carved carve(const Sent& sent, const Bench& bench, const Board& board,
             std::span<const Eigen::AlignedBox2d> looked_at = {}, const CutInto& cut = {});

/// Carves a design whose tool path compensates this setup's map: carve(compensated(designed)), except for rounding. For
/// a setup without fields and with adding grooves, the result equals the design.
Carved carve(const Designed& designed, const Bench& bench, const Board& board);

/// Marks grooves as carved: measured under a microscope, or made by a test.
Carved in_metal(Scratches grooves);

/// Backward pass: dE/d(designed rows) from dE/d(carved rows) (docs/model.md 7.7, 7.8), with `carved` = carve(designed,
/// bench, board). Pieces of a scratch move with its ends and with the grooves that cut it. Depths and roughnesses
/// follow their fields as a scratch moves; for this `by_carved` must hold derivatives by depth and alpha. Rows marked
/// `carved` get derivatives too; the caller keeps them fixed. Crossings that appear or vanish as scratches move
/// contribute no derivative.
ScratchGradients pull_back(const Carved& carved, const Designed& designed, const Bench& bench, const Board& board,
                           ScratchGradients by_carved);

}  // namespace burin
