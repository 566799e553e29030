// burin/capture/lamp_folders.h - the lamp of each photo, by its folder: photos/red/ holds photos under the lamp "red"
// alone. Photos themselves do not identify a lamp.
//
// A folder belongs to a lamp if its name is the lamp's, or the lamp's as a file name (base/files/file_names.h). Case
// does not matter.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace burin {

/// Known lamps of a folder of photos.
struct PhotoLamps {
  std::string of_folder;           ///< the lamp of photos in the folder itself; empty: unknown
  std::vector<std::string> names;  ///< possible names of subfolders
};

/// The folder of one lamp.
struct LampFolder {
  std::filesystem::path folder;
  std::string light;
};

/// Existing lamp folders, in the order of `lamps`. An unreadable folder counts as empty.
std::vector<LampFolder> lamp_folders(const std::filesystem::path& photos, const std::vector<std::string>& lamps);

/// The folder within `photos` for photos under `lamp`, one of `lamps`: the existing one, or the name for a new one.
std::filesystem::path lamp_folder(const std::filesystem::path& photos, const std::string& lamp,
                                  const std::vector<std::string>& lamps);

/// "photos/red, photos/green and photos/blue".
std::string lamp_folders_in_words(const std::filesystem::path& photos, const std::vector<std::string>& lamps);

}  // namespace burin
