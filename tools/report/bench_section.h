// tools/report/bench_section.h - the bench in space, inside a report: cameras, lamps, the board and how well each is
// known.
#pragma once

#include <string>

#include "burin/render/bench.h"
#include "burin/render/board.h"

namespace burin {

/// HTML with its heading. Frame: board, mm.
std::string bench_section(const Bench& bench, const Board& board);

}  // namespace burin
