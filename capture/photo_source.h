// burin/capture/photo_source.h - where photos come from: the one door through which they enter.
//
// A source is a function that hands out one photo after another and nothing when there are no more. Folders and
// files are all there is: a connected camera (tools/tether) puts its photos into a folder too.
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

/// Whether a photo comes before another by its name: IMG_9 before IMG_10.
bool in_name_order(const std::filesystem::path& a, const std::filesystem::path& b);

/// The photos of a folder (not of folders within), by name, IMG_9 before IMG_10. Hidden files are passed over in
/// silence, other files that are no photos with a finding; of the files of one shot, as far as headers, names and bytes
/// show them (pass_over_copies() in burin/capture/same_shot.h), one is taken.
/// Throws Error when the folder is missing, unreadable, or holds no photo.
PhotoSource folder_source(const std::filesystem::path& folder, std::vector<Finding>& findings);

/// The same, and of the folders within those that are named after lamps, all by name: IMG_9 before red/IMG_10. Other
/// folders with photos are an error among the findings where there are several lamps, else a note. Throws Error, too,
/// where photos lie in the folder itself and nobody knows their lamp.
PhotoSource folder_source(const std::filesystem::path& folder, const PhotoLamps& lamps, std::vector<Finding>& findings);

/// Photos and folders of photos as a person names them in a command line, in that order; none twice. Throws Error as
/// folder_source() does, and for a file that is missing.
PhotoSource named_source(const std::vector<std::filesystem::path>& names, std::vector<Finding>& findings);

}  // namespace burin
