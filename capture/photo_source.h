// burin/capture/photo_source.h - sources of photos: the one entry for all photos.
//
// A source is a function: it returns one photo after another, and nothing at the end. Folders and files are the only
// sources: a connected camera (tools/tether) also writes its photos into a folder.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "burin/base/finding.h"
#include "burin/capture/incoming_photo.h"
#include "burin/capture/lamp_folders.h"

namespace burin {

using PhotoSource = std::function<std::optional<IncomingPhoto>()>;

/// True if a photo precedes another by its name: IMG_9 before IMG_10.
bool in_name_order(const std::filesystem::path& a, const std::filesystem::path& b);

/// The photos of a folder, without its subfolders, by name: IMG_9 before IMG_10. Hidden files are skipped without a
/// message, other files that are no photos with a finding. One of the files of a shot is taken, as far as headers,
/// names and bytes show them (pass_over_copies() in burin/capture/same_shot.h). Throws Error when the folder is
/// missing, unreadable, or holds no photo.
PhotoSource folder_source(const std::filesystem::path& folder, std::vector<Finding>& findings);

/// The photos of a folder and of its subfolders named after lamps, all by name: IMG_9 before red/IMG_10. Other folders
/// with photos are an error among the findings if there are several lamps, else a note. Also throws Error if the folder
/// itself holds photos with an unknown lamp.
PhotoSource folder_source(const std::filesystem::path& folder, const PhotoLamps& lamps, std::vector<Finding>& findings);

/// Photos and folders of photos from a command line, in that order; none twice. Throws Error as folder_source() does,
/// and for a missing file.
PhotoSource named_source(const std::vector<std::filesystem::path>& names, std::vector<Finding>& findings);

}  // namespace burin
