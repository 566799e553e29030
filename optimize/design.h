// burin/optimize/design.h - inverse design: scratches that show a target picture in each view of a bench.
//
// `design` minimizes the loss of burin/optimize/loss/loss.h, summed over views. The unknowns are both ends of every
// scratch (paper, 3.4-3.5) and one exposure per view or lamp. Two end points beat midpoint, direction and length
// (paper, Fig. 20). Steps of Adam alternate with a re-insertion search (design/stroke_search.h). Pruning removes
// scratches with a small contribution.
//
// A design's pixels divide the carve area (board_grid). Each view sees them from its camera center under its lights, so
// the lens does not matter. The bench may be nominal or measured: every iteration carves the scratches as its machine
// would (burin/scene/carve.h), and the tool path compensates the affine machine calibration. Frame: board, mm. The same
// seed gives the same bits for any number of threads. Source: docs/model.md 6.
#pragma once

#include "burin/base/progress.h"
#include "burin/optimize/design_file.h"
#include "burin/optimize/design_options.h"
#include "burin/optimize/design_result.h"
#include "burin/scene/bench.h"
#include "burin/scene/board.h"

namespace burin {

/// Designs a board. Throws Error for a view or lamp that the bench does not have, unusable targets, a bench on which no
/// groove can glint, or options out of range. Other problems, such as collisions of views, are findings in the result.
/// `progress` may throw to stop the work.
DesignResult design(const DesignSpec& spec, const Board& board, const Bench& bench, const DesignOptions& options,
                    const Progress& progress);

}  // namespace burin
