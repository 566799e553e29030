// tools/report/bench_section.h - the bench in space, inside a report: cameras, lamps, the board and how well each is
// known. The page that holds it needs bench_scene_script() and bench_scene_style() (tools/view/bench_scene.h).
#pragma once

#include <string>
#include <vector>

#include "burin/scene/bench.h"
#include "burin/scene/board.h"
#include "tools/match_views.h"

namespace burin {

/// HTML with its heading (text), such as "The bench as measured". `tolerances`: how far eyes may stand aside, by
/// shown_tolerances(); may be empty. Frame: board, mm.
std::string bench_section(const Bench& bench, const Board& board, const std::vector<MatchTolerance>& tolerances,
                          const std::string& heading);

}  // namespace burin
