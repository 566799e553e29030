#include "burin/capture/lamp_folders.h"

#include <algorithm>
#include <utility>

#include "burin/base/files/file_names.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

// Folders in `photos`, by name. If two differ only in case, the same one always comes first.
std::vector<fs::path> folders_in(const fs::path& photos) {
  std::vector<fs::path> out;
  std::error_code error;
  fs::directory_iterator entry(photos, error), end;
  for (; !error && entry != end; entry.increment(error)) {
    std::error_code ignored;
    if (entry->is_directory(ignored)) out.push_back(entry->path());
  }
  std::sort(out.begin(), out.end());
  return out;
}

// The lamp of a folder's name: an exact match before a match of file names. -1: none.
int lamp_of(const std::string& folder, const std::vector<std::string>& lamps, const std::vector<std::string>& files) {
  const std::string name = lower_case(folder);
  for (const bool whole : {true, false})
    for (const auto* list : {&lamps, &files})
      for (std::size_t i = 0; i < list->size(); ++i)
        if (whole ? (*list)[i] == folder : lower_case((*list)[i]) == name) return static_cast<int>(i);
  return -1;
}

}  // namespace

std::vector<LampFolder> lamp_folders(const fs::path& photos, const std::vector<std::string>& lamps) {
  const std::vector<std::string> files = distinct_file_names(lamps);
  std::vector<std::pair<int, LampFolder>> found;
  for (const fs::path& folder : folders_in(photos))
    if (const int lamp = lamp_of(folder.filename().string(), lamps, files); lamp >= 0)
      found.push_back({lamp, {folder, lamps[static_cast<std::size_t>(lamp)]}});
  std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<LampFolder> out;
  out.reserve(found.size());
  for (auto& [lamp, folder] : found) out.push_back(std::move(folder));
  return out;
}

fs::path lamp_folder(const fs::path& photos, const std::string& lamp, const std::vector<std::string>& lamps) {
  for (const LampFolder& there : lamp_folders(photos, lamps))
    if (there.light == lamp) return there.folder;
  const std::vector<std::string> files = distinct_file_names(lamps);
  const auto found = std::find(lamps.begin(), lamps.end(), lamp);
  return photos / (found == lamps.end() ? file_name_of(lamp) : files[static_cast<std::size_t>(found - lamps.begin())]);
}

std::string lamp_folders_in_words(const fs::path& photos, const std::vector<std::string>& lamps) {
  std::string out;
  for (std::size_t i = 0; i < lamps.size(); ++i)
    out += (i == 0 ? "" : i + 1 == lamps.size() ? " and " : ", ") + lamp_folder(photos, lamps[i], lamps).string();
  return out;
}

}  // namespace burin
