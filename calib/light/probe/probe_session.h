// burin/calib/light/probe/probe_session.h - plain photos of a mirror ball into a session: as `burin capture` sorts
// them, but what is too dark to show a tag belongs to the place beside it.
#pragma once

#include <optional>

#include "burin/capture/folder_session.h"
#include "burin/scene/lens.h"

namespace burin {

/// Joins views in which no tag is seen with the one that was photographed right before or after, whichever is nearer in
/// time (the one before, where photos tell no time), and at most a minute away: the shortest exposures of a bracket
/// hold the sun and nothing else. Views keep their order and the other views' names.
void join_dark_views(FolderSession& folder);

/// A lens as EXIF tells it, by the 35 mm equivalent of the first photo that has one. Nothing where none does.
std::optional<Lens> lens_by_exif(const FolderSession& folder);

}  // namespace burin
