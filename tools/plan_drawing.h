// tools/plan_drawing.h - a plan of photos as a drawing: the bench from above and from the side, to scale.
#pragma once

#include <string>

#include "burin/calib/plan.h"
#include "burin/scene/board.h"

namespace burin {

/// SVG. Above: x right, y up, the board with its tags, numbered cameras with their lines of sight, lamps as stars.
/// Below: the same seen from the lower edge, x right, height up.
std::string plan_drawing(const Plan& plan, const Board& board);

}  // namespace burin
