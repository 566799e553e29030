// tools/report/bench_section.h - three-dimensional view of the bench in a report: cameras, lamps, board and their
// uncertainties. The page also needs bench_scene_script() and bench_scene_style() (tools/view/bench_scene.h).
#pragma once

#include <string>
#include <vector>

#include "burin/scene/bench.h"
#include "burin/scene/board.h"
#include "tools/match_views.h"

namespace burin {

/// Returns HTML with its heading (text), such as "The bench as measured". `tolerances`: of the eyes, by
/// shown_tolerances(); may be empty. Frame: board, mm.
std::string bench_section(const Bench& bench, const Board& board, const std::vector<MatchTolerance>& tolerances,
                          const std::string& heading);

}  // namespace burin
