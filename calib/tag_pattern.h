// calib/tag_pattern.h - what is printed on a tag's paper: which of its cells are white.
// Frame: the upright tag's own (x right, y up, origin at its centre), in units of one cell (module).
// Source: AprilTag's own drawing of each tag, so every family that it knows is right, borders outside included.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace burin {

/// The printed square of one tag. The corners that AprilTag reports enclose `border_cells` cells, the paper
/// `total_cells`.
struct TagPattern {
  int total_cells = 0;
  int border_cells = 0;
  std::vector<std::uint8_t> white;  ///< total_cells^2, row 0 at the top (largest y): 1 white, 0 black

  /// -1 outside of the paper, else 0 (black) or 1 (white) at a point of the tag's frame, in cells.
  int color_at(double x_cells, double y_cells) const;
};

/// The pattern of tag `id` of `family` ("tagStandard41h12", "tag36h11", ...). Throws Error for a family that AprilTag
/// does not know or an id that the family does not have.
TagPattern tag_pattern(const std::string& family, int id);

}  // namespace burin
