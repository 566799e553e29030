// burin/calib/light/probe/probe_session.h - sorts plain photos of a mirror ball into a session as `burin capture` does.
// Photos too dark to show a tag join a neighboring view.
#pragma once

#include <optional>

#include "burin/capture/folder_session.h"
#include "burin/scene/lens.h"

namespace burin {

/// Joins views without a detected tag with the view photographed right before or after, the nearer in time and at most
/// a minute away. Without times it is the view before. The shortest exposures of a bracket show only the sun. Views
/// keep their order and the other views' names.
void join_dark_views(FolderSession& folder);

/// A lens from the 35 mm equivalent focal length in EXIF, by the first photo with one. Empty if no photo has one.
std::optional<Lens> lens_by_exif(const FolderSession& folder);

}  // namespace burin
