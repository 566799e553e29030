// burin/capture/folder_session.h - plain photos to a session: view, exposure and encoding of each photo.
//
// Photos are ordered by their clock, or by their names if a file has no time. A photo joins the previous view if at
// most a minute passed and both pictures agree: the same details at the same places, at any exposure
// (burin/capture/photo_look.h). A camera that moved by more than half a pixel starts a new view, with a pose of its
// own. Views are called v00, v01, ... Each photo shows one lamp: the caller's, or the lamp of the photo's folder
// (burin/capture/lamp_folders.h). Photos under another lamp join the previous view if the tags stayed in place: glints
// differ then, but the camera did not move.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "burin/base/finding.h"
#include "burin/base/progress.h"
#include "burin/capture/photo_look.h"
#include "burin/capture/photo_source.h"
#include "burin/capture/session.h"

namespace burin {

/// The ordered photos of a folder.
struct FolderSession {
  Session session;               ///< usable photos, in order; `file` and `board` are empty
  std::vector<Exif> exif;        ///< one per photo of the session
  std::vector<PhotoLook> looks;  ///< one per photo of the session
  std::vector<Finding> findings;
};

/// Takes all photos of a source and searches them for `tags`. `light` names the lamp of photos whose source has none.
/// `f_number` applies to photos without one in EXIF; 0: not known. Findings: broken files are errors. A file without
/// exposure time or aperture is left out with a warning; if all lack it, this is an error. A missing ISO counts as 100,
/// with a warning. If no file has an aperture (a lens unknown to the camera), all get kAssumedAperture. One of several
/// files of a shot is taken. Photos with digital zoom or flash, unlike most, are left out with a warning. Throws if
/// `progress` does, and for an unknown tag family.
FolderSession session_from(const PhotoSource& source, const TagSet& tags, const Progress& progress = {},
                           const std::string& light = Photo().light, double f_number = 0);

/// Result of `burin capture`.
struct CaptureResult {
  Session session;
  std::vector<Finding> findings;
  std::filesystem::path written;  ///< DIR/session.json; empty, and nothing written, if errors were found
  int views = 0;
};

/// `burin capture`: makes DIR/session.json from a folder of photos and a board, after the pre-flight check
/// (burin/capture/preflight.h). Throws Error for a missing folder or one without photos, an unreadable board, an
/// unwritable folder, and photos with an unknown lamp.
CaptureResult capture_folder(const std::filesystem::path& photos_dir, const std::filesystem::path& board_json,
                             const std::filesystem::path& out_dir, const Progress& progress = {},
                             const PhotoLamps& lamps = {Photo().light, {}}, double f_number = 0);

}  // namespace burin
