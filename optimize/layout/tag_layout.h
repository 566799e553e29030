// burin/optimize/layout/tag_layout.h - a new board's tags: a ring of AprilTags along the edges, the carve area inside.
// Frame: board, mm.
#pragma once

#include <Eigen/Core>

#include "burin/scene/board.h"

namespace burin {

/// The sides of the tags, whole mm, that fit a board of this size. `usual_mm` leaves most of the board to the pictures;
/// `largest_mm` leaves half of its width and height.
struct TagSizes {
  double usual_mm = 0, largest_mm = 0;
};

/// Throws Error for a board without room for tags of 4 mm (sides below about 38 mm), or larger than 5 m.
TagSizes tag_sizes(const Eigen::Vector2d& board_mm);

/// A board with a ring of 8 to some 20 tags of the family tagStandard41h12. Their paper is 1.8 times as wide as
/// `tag_mm`. Papers are 1 mm inside of the edges and do not touch; their centers are on whole mm. Tags are numbered
/// counter-clockwise from the lower left corner and glued by hand (sigma_mm 0.5). The carve area begins 1 mm inside of
/// the papers, on whole mm. Throws Error if the tags do not fit.
Board board_with_tags(const Eigen::Vector2d& board_mm, double tag_mm);

}  // namespace burin
