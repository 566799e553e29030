// tools/where_to_stand.h - where lamp and camera go for the views that a board is designed for, in words and mm: what a
// person needs beside the board, before the first photo. The further photos are `burin plan`'s.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "burin/optimize/design_file.h"
#include "burin/scene/bench.h"
#include "burin/scene/board.h"
#include "tools/match_views.h"

namespace burin {

/// Lines, each ending in a newline and none indented: the lamps, each designed view with how far its eye may stand
/// aside (`tolerances`: by shown_tolerances()), focus, and exposures: in seconds where the bench was measured. Throws
/// Error for views and lamps that the bench lacks.
std::string where_to_stand(const DesignSpec& design, const Bench& bench, const Board& board,
                           const std::vector<MatchTolerance>& tolerances);

/// The median distance of eyes from the board's middle, mm: where the lens is focused for all photos. 0 without eyes.
double focus_distance_mm(const std::vector<Eigen::Vector3d>& eyes_mm, const Board& board);

}  // namespace burin
