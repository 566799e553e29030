// burin/optimize/layout/tag_layout.h - a new board's tags: a ring of AprilTags along the edges, the carve area within.
// Frame: board, mm.
#pragma once

#include <Eigen/Core>

#include "burin/scene/board.h"

namespace burin {

/// The sides of the tags, whole mm, that a board of this size can have. `usual_mm` leaves most of the board to the
/// pictures; `largest_mm` leaves half of its width and height.
struct TagSizes {
  double usual_mm = 0, largest_mm = 0;
};

/// Throws Error for a board on which no tag of 4 mm has room (sides below about 38 mm), or one larger than 5 m.
TagSizes tag_sizes(const Eigen::Vector2d& board_mm);

/// A board with a ring of 8 to some 20 tags of the family tagStandard41h12, whose paper is 1.8 times as wide as
/// `tag_mm`: 1 mm in from the edges, centers on whole mm, papers apart, numbered counter-clockwise from the lower left
/// corner, glued by hand (sigma_mm 0.5). The carve area begins 1 mm inside of the papers, on whole mm. Throws Error for
/// tags that have no room.
Board board_with_tags(const Eigen::Vector2d& board_mm, double tag_mm);

}  // namespace burin
