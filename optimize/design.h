// burin/optimize/design.h - the inverse problem: scratches that show a target picture in each view of a bench.
//
// Minimizes the loss of burin/optimize/loss/loss.h, summed over views, over both ends of every scratch (paper, 3.4-3.5;
// two end points beat midpoint, direction and length, Fig. 20) and over one exposure a view or a lamp, by Adam's steps
// and searches for better places in turns (design/stroke_search.h); on the way it drops the scratches that hardly
// contribute. The pixels are those of the picture as it lies on the carve area (board_grid), seen from each view's
// camera center under its lights: the lens does not matter. The bench may be nominal or measured: in every iteration
// the scratches are carved as its machine would (burin/scene/carve.h), the tool path compensating its map. Frame:
// board, mm. Same seed, same bits, for any number of threads. Sources: docs/model.md 6.
#pragma once

#include "burin/base/progress.h"
#include "burin/optimize/design_file.h"
#include "burin/optimize/design_options.h"
#include "burin/optimize/design_result.h"
#include "burin/scene/bench.h"
#include "burin/scene/board.h"

namespace burin {

/// Designs a board. Throws Error for a view or lamp the bench does not have, targets that cannot be used, a bench on
/// which no groove can glint, options out of range. Collisions of views and the like are findings in the result.
/// `progress` may throw to stop the work.
DesignResult design(const DesignSpec& spec, const Board& board, const Bench& bench, const DesignOptions& options,
                    const Progress& progress);

}  // namespace burin
