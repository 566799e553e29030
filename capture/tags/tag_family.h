// burin/capture/tags/tag_family.h - AprilTag's families: names, the library's own tables, and the printed pattern of a
// tag. Source: AprilTag's own drawing of each tag. So every known family is correct, with borders outside of the code
// too.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

struct apriltag_family;  // apriltag.h's apriltag_family_t

namespace burin {

/// The families known to libapriltag, most usual first.
std::span<const char* const> tag_families();

using TagFamily = std::unique_ptr<apriltag_family, void (*)(apriltag_family*)>;

/// AprilTag's tables of a family. Throws Error for an unknown name, with the known ones and `where` the name was read
/// ("board.json: tags.family").
TagFamily make_tag_family(const std::string& name, const std::string& where);

/// The printed square of one tag. AprilTag's corners enclose `border_cells` cells, the paper `total_cells`. Frame: the
/// upright tag's own (x right, y up, origin at its center), in units of one cell (module).
struct TagPattern {
  int total_cells = 0;
  int border_cells = 0;
  std::vector<std::uint8_t> white;  ///< total_cells^2, row 0 at the top (largest y): 1 white, 0 black

  /// Color at a point of the tag's frame, in cells: 0 black, 1 white, -1 outside of the paper.
  int color_at(double x_cells, double y_cells) const;
};

/// The pattern of tag `id`. Throws Error for an id outside of the family; `where` names the list of tags.
TagPattern tag_pattern(const apriltag_family& family, int id, const std::string& where);

/// The pattern by the family's name ("tagStandard41h12", "tag36h11", ...).
TagPattern tag_pattern(const std::string& family, int id);

}  // namespace burin
