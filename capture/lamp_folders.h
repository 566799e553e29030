// burin/capture/lamp_folders.h - which lamp was on in which photo, by the folders that photos lie in: photos/red/ holds
// those under the lamp "red" alone. Photos themselves do not tell.
//
// A folder is a lamp's where its name is the lamp's, or the lamp's as a name of files (base/files/file_names.h), in
// capitals or small letters.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace burin {

/// What is known of the lamps in a folder of photos.
struct PhotoLamps {
  std::string of_folder;           ///< the lamp of photos in the folder itself; empty: nobody knows which was on
  std::vector<std::string> names;  ///< lamps that folders within may be named after
};

/// The folder of one lamp.
struct LampFolder {
  std::filesystem::path folder;
  std::string light;
};

/// Those that are there, in the order of `lamps`; a folder that cannot be read counts as empty.
std::vector<LampFolder> lamp_folders(const std::filesystem::path& photos, const std::vector<std::string>& lamps);

/// The folder within `photos` for photos under `lamp`, one of `lamps`: as it is there, or as it is to be called.
std::filesystem::path lamp_folder(const std::filesystem::path& photos, const std::string& lamp,
                                  const std::vector<std::string>& lamps);

/// "photos/red, photos/green and photos/blue".
std::string lamp_folders_in_words(const std::filesystem::path& photos, const std::vector<std::string>& lamps);

}  // namespace burin
