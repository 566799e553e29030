// burin/capture/tags/tag_family.h - AprilTag's families: their names, the library's own tables, and what is printed on
// a tag. Source: AprilTag's own drawing of each tag, so every family that it knows is right, borders outside included.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

struct apriltag_family;  // apriltag.h's apriltag_family_t

namespace burin {

/// The families that libapriltag knows, most usual first.
std::span<const char* const> tag_families();

using TagFamily = std::unique_ptr<apriltag_family, void (*)(apriltag_family*)>;

/// AprilTag's tables of a family. Throws Error for a name that it does not know, saying `where` the name stands
/// ("board.json: tags.family") and which it does know.
TagFamily make_tag_family(const std::string& name, const std::string& where);

/// The printed square of one tag. The corners that AprilTag reports enclose `border_cells` cells, the paper
/// `total_cells`. Frame: the upright tag's own (x right, y up, origin at its center), in units of one cell (module).
struct TagPattern {
  int total_cells = 0;
  int border_cells = 0;
  std::vector<std::uint8_t> white;  ///< total_cells^2, row 0 at the top (largest y): 1 white, 0 black

  /// -1 outside of the paper, else 0 (black) or 1 (white) at a point of the tag's frame, in cells.
  int color_at(double x_cells, double y_cells) const;
};

/// The pattern of tag `id`. Throws Error for an id that the family does not have; `where` names the list of tags.
TagPattern tag_pattern(const apriltag_family& family, int id, const std::string& where);

/// The same from the family's name ("tagStandard41h12", "tag36h11", ...).
TagPattern tag_pattern(const std::string& family, int id);

}  // namespace burin
