// burin/calib/verdict/planned_tags.h - selection of tags for plans of photos on boards with very many tags.
#pragma once

#include <cstddef>

#include "burin/scene/board.h"

namespace burin {

/// Largest number of tags in a plan. The work grows with the cube of their number, and beyond dozens of tags the
/// information about lens, poses and bow hardly changes.
constexpr std::size_t kMostPlannedTags = 60;

/// The board with at most kMostPlannedTags of its tags, or all if it has no more. They are as far apart as possible:
/// each is the one furthest from the earlier ones.
Board with_planned_tags(const Board& board);

}  // namespace burin
