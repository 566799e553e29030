// tools/plan_drawing.h - drawing to scale of a photo plan: the bench from above and from the side.
#pragma once

#include <string>

#include "burin/calib/plan.h"
#include "burin/scene/board.h"

namespace burin {

/// Returns SVG. Top view: x right, y up, the board with its tags, numbered cameras with lines of sight, lamps as stars.
/// Below it, the view from the lower edge: x right, height up.
std::string plan_drawing(const Plan& plan, const Board& board);

}  // namespace burin
