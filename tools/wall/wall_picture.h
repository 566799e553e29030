// tools/wall/wall_picture.h - the pictures that all boards of a wall show together, beside their targets.
#pragma once

#include <filesystem>

#include "tools/facts.h"

namespace burin {

/// Writes WALL/wall-VIEW.png for each view: the boards' predicted pictures in their places, the targets, and the
/// differences around gray. Uses the latest designs, or the previews of boards without one. Reports each view's PSNR
/// over all carve areas, and the seams: how much brighter than wanted one board is beside its neighbor. Throws Error if
/// a board has neither.
Report picture_of_wall(const std::filesystem::path& folder);

}  // namespace burin
