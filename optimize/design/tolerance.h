// burin/optimize/design/tolerance.h - how far eye and lamp may stand from where they are meant to before a picture is
// lost.
//
// A view is lost where its PSNR (at the exposure that suits it best there: eyes adapt) has fallen by kLostDb. Eye and
// lamp are moved one at a time from their places in the bench, sideways (level, parallel to the face), up (at right
// angles to that and to the line of sight), and in depth (along that line). Measured by rendering, on a grid of at most
// kTolerancePixels a side; on finer grids pictures have more noise of their own and lose 3 dB later.
// Frame: board, mm.
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

/// Distances to both sides at which a view is lost; never more than half the distance to the board.
struct MoveRange {
  double minus_mm = 0, plus_mm = 0;
  /// The smaller of both ways.
  double least() const { return std::min(minus_mm, plus_mm); }
};

/// How far an eye or a lamp may move from its place, mm.
struct PlaceTolerance {
  MoveRange sideways, up, depth;  ///< plus: to the right as seen from there, upwards, away from the board
};

/// How much of a view is lost when eye or lamp move.
struct ViewTolerance {
  double psnr_db = 0;  ///< with eye and lamp in their places, on the grid that this was measured on
  PlaceTolerance eye, lamp;
  Image lost_db;           ///< eye moved sideways (columns, to the right) and up (rows, row 0 uppermost)
  double map_half_mm = 0;  ///< the outermost column and row stand for this far
};

/// What a view is compared with.
struct ToleranceTarget {
  Image target, mask;                    ///< as in burin/optimize/target.h
  double exposure = 0;                   ///< near the best
  std::array<double, 3> gains{1, 1, 1};  ///< of a target in color: DesignedColor::white_gain
};

/// One for each of the spec's views, whose `targets` come in the same order. Once `stop` (may be empty) returns true,
/// only of those that were measured until then.
std::vector<ViewTolerance> measure_tolerance(const DesignSpec& spec, const Board& board, const Bench& bench,
                                             const std::vector<ToleranceTarget>& targets, const Scratches& scratches,
                                             const Progress& progress, const std::function<bool()>& stop = {});

/// "view v2 holds within 18 mm sideways, 20 mm up or down, 40 mm in depth; its lamp within 17, 22 and 41 mm".
std::string tolerance_text(const std::string& view, const ViewTolerance& tolerance);

}  // namespace burin
