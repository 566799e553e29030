// tools/where_to_stand.h - positions of lamp and camera for a design's views, in words and mm, for the time before the
// first photo. `burin plan` handles all other photos.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "burin/optimize/design_file.h"
#include "burin/scene/bench.h"
#include "burin/scene/board.h"
#include "tools/match_views.h"

namespace burin {

/// Returns unindented lines, each with a newline. They give the lamps, the designed views with the tolerance of each
/// eye (`tolerances`: by shown_tolerances()), focus and exposures. A measured bench has exposures in seconds. Throws
/// Error for views and lamps missing in the bench.
std::string where_to_stand(const DesignSpec& design, const Bench& bench, const Board& board,
                           const std::vector<MatchTolerance>& tolerances);

/// Returns the focus distance of all photos: the median distance of the eyes from the board's center, mm. 0 without
/// eyes.
double focus_distance_mm(const std::vector<Eigen::Vector3d>& eyes_mm, const Board& board);

}  // namespace burin
