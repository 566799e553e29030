// burin/capture/folder_session.h - plain photos become a session: which belong to one view, how each was exposed and
// encoded.
//
// Photos are taken in the order of their clock (of their names where a file has no time). A photo joins the view of the
// one before it when at most a minute passed and the two pictures agree: the same details at the same place, whatever
// the exposures (burin/capture/photo_look.h). A camera that moved by more than half a pixel is at another view: its
// pose will be solved on its own. Views are called v00, v01, ... Each photo shows one lamp: the one that the caller
// names, or that of the folder it lies in (burin/capture/lamp_folders.h). Photos under another lamp join the view
// before them where the tags have stayed in their places: what glints differs, but not where the camera stands.
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

/// Photos of a folder, put in order.
struct FolderSession {
  Session session;               ///< the photos that could be used, in order; `file` and `board` are left empty
  std::vector<Exif> exif;        ///< one a photo of the session
  std::vector<PhotoLook> looks;  ///< one a photo of the session
  std::vector<Finding> findings;
};

/// Takes all photos of a source and looks for `tags` in them. Broken files become errors among the findings. A file
/// without exposure time or aperture is left out with a warning, and an error where no file has them; a missing ISO is
/// taken as 100 with a warning. If no file has an aperture (a lens that the camera does not know), all are taken at
/// kAssumedAperture. Of several files of one shot one is taken; photos that were zoomed digitally or lit by the flash,
/// unlike most, are left out with a warning. Throws if `progress` does, and for tags of an unknown family. `light`: the
/// lamp's name for photos whose source has none. `f_number`: of photos whose EXIF has none; 0: not known.
FolderSession session_from(const PhotoSource& source, const TagSet& tags, const Progress& progress = {},
                           const std::string& light = Photo().light, double f_number = 0);

/// What became of a folder of photos.
struct CaptureResult {
  Session session;
  std::vector<Finding> findings;
  std::filesystem::path written;  ///< DIR/session.json; empty if errors were found, and then nothing was written
  int views = 0;
};

/// `burin capture`: a folder of photos and a board become DIR/session.json, after the pre-flight
/// (burin/capture/preflight.h). Throws Error for a folder that is missing or holds no photo, a board that cannot be
/// read, a folder that cannot be written, and photos of which nobody knows the lamp.
CaptureResult capture_folder(const std::filesystem::path& photos_dir, const std::filesystem::path& board_json,
                             const std::filesystem::path& out_dir, const Progress& progress = {},
                             const PhotoLamps& lamps = {Photo().light, {}}, double f_number = 0);

}  // namespace burin
