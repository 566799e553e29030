// burin/capture/photo_source.h - where photos come from: the one door through which they enter.
//
// A source is a function that hands out one photo after another and nothing when there are no more. A folder is the
// only one: a connected camera (tools/tether) puts its photos into a folder too.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "burin/capture/exif.h"
#include "burin/render/finding.h"

namespace burin {

/// A photo before its pixels are read.
struct IncomingPhoto {
  std::filesystem::path file;
  Exif exif;
  std::string unreadable;  ///< why its header could not be read; empty if it could
};

using PhotoSource = std::function<std::optional<IncomingPhoto>()>;

/// Whether a photo comes before another by its name: IMG_9 before IMG_10.
bool in_name_order(const std::filesystem::path& a, const std::filesystem::path& b);

/// The photos of a folder (not of folders within), by name, IMG_9 before IMG_10. Hidden files are passed over in
/// silence, other files that are no photos with a finding; of a raw file and a JPEG of one name the raw file is taken.
/// Throws Error when the folder is missing, unreadable, or holds no photo.
PhotoSource folder_source(const std::filesystem::path& folder, std::vector<Finding>& findings);

}  // namespace burin
