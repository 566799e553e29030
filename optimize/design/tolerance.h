// burin/optimize/design/tolerance.h - viewing zone: distances of eye and lamp from their intended places at which a
// picture is lost.
//
// A view is lost if its PSNR has fallen by kLostDb, at the best exposure of each position (eyes adapt). Eye and lamp
// move one at a time from their places in the bench: sideways, up and in depth. Sideways is level and parallel to the
// face, depth is along the line of sight, and up is at right angles to both. The measurement renders on a grid of at
// most kTolerancePixels a side. On finer grids pictures have more noise of their own and lose 3 dB later. Frame: board,
// mm.
#pragma once

#include <algorithm>
#include <array>
#include <functional>
#include <string>
#include <vector>

#include "burin/base/image.h"
#include "burin/base/progress.h"
#include "burin/optimize/design_file.h"
#include "burin/scene/bench.h"
#include "burin/scene/board.h"
#include "burin/scene/scratches.h"

namespace burin {

inline constexpr double kLostDb = 3;
inline constexpr int kTolerancePixels = 256;

/// Distances to both sides at which a view is lost; at most half the distance to the board.
struct MoveRange {
  double minus_mm = 0, plus_mm = 0;
  /// The smaller distance.
  double least() const { return std::min(minus_mm, plus_mm); }
};

/// Viewing zone of an eye or a lamp around its place, mm.
struct PlaceTolerance {
  MoveRange sideways, up, depth;  ///< plus: to the right as seen from there, upwards, away from the board
};

/// Viewing zone of a view's eye and lamp.
struct ViewTolerance {
  double psnr_db = 0;  ///< with eye and lamp in place, on this measurement's grid
  PlaceTolerance eye, lamp;
  Image lost_db;           ///< eye moved sideways (columns, to the right) and up (rows, row 0 uppermost)
  double map_half_mm = 0;  ///< distance at the outermost columns and rows
};

/// Reference of a view.
struct ToleranceTarget {
  Image target, mask;                    ///< as in burin/optimize/target.h
  double exposure = 0;                   ///< initial guess of the best
  std::array<double, 3> gains{1, 1, 1};  ///< of a target in color: DesignedColor::white_gain
};

/// Measures each of the spec's views, with `targets` in the same order. Once `stop` (may be empty) returns true, the
/// result has only the views measured so far.
std::vector<ViewTolerance> measure_tolerance(const DesignSpec& spec, const Board& board, const Bench& bench,
                                             const std::vector<ToleranceTarget>& targets, const Scratches& scratches,
                                             const Progress& progress, const std::function<bool()>& stop = {});

/// "view v2 holds within 18 mm sideways, 20 mm up or down, 40 mm in depth; its lamp within 17, 22 and 41 mm".
std::string tolerance_text(const std::string& view, const ViewTolerance& tolerance);

}  // namespace burin
