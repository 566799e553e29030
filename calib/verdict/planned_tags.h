// burin/calib/verdict/planned_tags.h - which of very many tags a plan of photos is made with.
#pragma once

#include <cstddef>

#include "burin/scene/board.h"

namespace burin {

/// Above so many tags a plan is made with some of them: the work grows with the cube of their number, and what a photo
/// tells of lens, poses and bow hardly changes once there are dozens.
constexpr std::size_t kMostPlannedTags = 60;

/// The board with at most kMostPlannedTags of its tags, spread as far apart as they go (each is the one furthest from
/// those before it); with all of them, if they are no more.
Board with_planned_tags(const Board& board);

}  // namespace burin
