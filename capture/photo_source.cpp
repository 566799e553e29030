#include "burin/capture/photo_source.h"

#include <algorithm>
#include <cctype>
#include <memory>
#include <string_view>
#include <utility>

#include "burin/base/error.h"
#include "burin/base/files/input_file.h"
#include "burin/base/files/printable.h"
#include "burin/base/limits.h"
#include "burin/capture/same_shot.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

// Compares numbers within names as numbers.
bool natural_less(const std::string& a, const std::string& b) {
  std::size_t i = 0, j = 0;
  const auto digit = [](char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; };
  while (i < a.size() && j < b.size()) {
    if (digit(a[i]) && digit(b[j])) {
      const auto number = [&](const std::string& s, std::size_t& at) {
        while (at < s.size() && s[at] == '0') ++at;
        const std::size_t begin = at;
        while (at < s.size() && digit(s[at])) ++at;
        return std::string_view(s).substr(begin, at - begin);
      };
      const std::string_view m = number(a, i), n = number(b, j);
      if (m.size() != n.size()) return m.size() < n.size();
      if (m != n) return m < n;
    } else {
      if (a[i] != b[j]) return a[i] < b[j];
      ++i;
      ++j;
    }
  }
  if (a.size() - i != b.size() - j) return a.size() - i < b.size() - j;
  return a < b;
}

// Entries of a folder, one after the other. Throws Error for a missing or unreadable folder.
fs::directory_iterator entries_of(const fs::path& folder) {
  std::error_code error;
  if (!fs::is_directory(folder, error))
    fail(folder.string(), "there is no such folder", "give the folder that holds the photos");
  fs::directory_iterator entries(folder, error);
  if (error) fail(folder.string(), "cannot be read (" + error.message() + ")", "give yourself the right to read it");
  return entries;
}

// The photos of a folder, without its subfolders.
std::vector<fs::path> photos_in(const fs::path& folder, std::vector<Finding>& findings) {
  std::vector<fs::path> files;
  std::error_code error;
  for (const fs::directory_entry& entry : entries_of(folder)) {
    const std::string name = entry.path().filename().string();
    if (name.front() == '.' || !entry.is_regular_file(error)) continue;
    if (!is_printable(name)) {
      findings.push_back({FindingCode::file_ignored, Finding::Severity::warning, entry.path(),
                          "was passed over: its name holds bytes that are no text", "rename the file"});
      continue;
    }
    if (!is_photo(entry.path())) {
      // A photo's name with other bytes is a damaged photo; its reader reports it.
      if (is_sidecar_name(entry.path())) continue;
      if (!is_photo_name(entry.path())) {
        findings.push_back(
            {FindingCode::file_ignored, Finding::Severity::note, entry.path(), "is no photo and was passed over", ""});
        continue;
      }
    }
    files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end(), in_name_order);
  return files;
}

// Names folders with photos but without a lamp: no photo is left out without a message.
std::vector<fs::path> find_other_folders(const fs::path& folder, const PhotoLamps& lamps,
                                         const std::vector<LampFolder>& known, std::vector<Finding>& findings) {
  std::vector<fs::path> others, with_photos;
  std::error_code error;
  for (const fs::directory_entry& entry : entries_of(folder))
    if (entry.path().filename().string().front() != '.' && entry.is_directory(error) &&
        std::none_of(known.begin(), known.end(), [&](const LampFolder& l) { return l.folder == entry.path(); }))
      others.push_back(entry.path());
  std::sort(others.begin(), others.end(), in_name_order);
  for (const fs::path& other : others) {
    fs::directory_iterator inside(other, error), end;
    bool photos = false;
    for (; !error && !photos && inside != end; inside.increment(error)) photos = is_photo(inside->path());
    if (!photos) continue;
    with_photos.push_back(other);
    if (lamps.names.size() < 2)
      findings.push_back({FindingCode::file_ignored, Finding::Severity::warning, other,
                          "holds photos, and folders within are passed over",
                          "if it is a lamp's that shone on them alone, list that lamp in bench.json (\"lights\")"});
    else
      findings.push_back({FindingCode::lamp_folder, Finding::Severity::error, other,
                          "holds photos, and no lamp of the bench is called that",
                          "rename it: " + lamp_folders_in_words(folder, lamps.names) +
                              " are known; or, if its photos are not to be used, put a dot before its name"});
  }
  return with_photos;
}

// Skipped files, for a folder without photos: " (a.jpg: is ...)".
std::string passed_over_text(const std::vector<Finding>& findings) {
  constexpr std::size_t kNamed = 3;
  std::string text;
  for (std::size_t i = 0; i < std::min(findings.size(), kNamed); ++i)
    text += (i == 0 ? " (" : ", ") + sentence(findings[i]);
  if (findings.size() > kNamed) text += ", and " + std::to_string(findings.size() - kNamed) + " more";
  return text.empty() ? text : text + ")";
}

// Reads headers at once: they show which files are one shot.
PhotoSource source_of(std::vector<IncomingPhoto> photos, std::vector<Finding>& findings) {
  require_at_most(photos.size(), limit::kPhotos, "the photos", "files",
                  "take some of them into a folder of their own: a few dozen from many directions are enough");
  for (IncomingPhoto& photo : photos) {
    try {
      photo.exif = read_exif(photo.file);
    } catch (const Error& unreadable) {
      photo.unreadable = unreadable.what();
    }
  }
  pass_over_copies(photos, findings);
  const auto list = std::make_shared<const std::vector<IncomingPhoto>>(std::move(photos));
  return [list, next = std::size_t{0}]() mutable -> std::optional<IncomingPhoto> {
    if (next == list->size()) return std::nullopt;
    return (*list)[next++];
  };
}

}  // namespace

bool in_name_order(const fs::path& a, const fs::path& b) {
  return natural_less(a.filename().string(), b.filename().string());
}

PhotoSource folder_source(const fs::path& folder, std::vector<Finding>& findings) {
  return folder_source(folder, {}, findings);
}

PhotoSource folder_source(const fs::path& folder, const PhotoLamps& lamps, std::vector<Finding>& findings) {
  std::vector<IncomingPhoto> photos;
  for (const fs::path& file : photos_in(folder, findings)) photos.push_back({file, {}, {}, lamps.of_folder});
  if (!photos.empty() && lamps.of_folder.empty() && !lamps.names.empty()) {
    const std::string folders = lamp_folders_in_words(folder, lamps.names);
    fail(photos.front().file.string(),
         (photos.size() == 1 ? "lies" : "and " + std::to_string(photos.size() - 1) + " more lie") +
             " in no lamp's folder, and a photo does not show which of several lamps was on",
         "put each photo into the folder of the lamp that shone on it alone (" + folders +
             "); or, for photos that are all under one, name it: burin capture --lamp NAME");
  }
  const std::vector<LampFolder> known = lamp_folders(folder, lamps.names);
  for (const LampFolder& lamp : known)
    for (const fs::path& file : photos_in(lamp.folder, findings)) photos.push_back({file, {}, {}, lamp.light});
  const std::vector<fs::path> others = find_other_folders(folder, lamps, known, findings);
  if (photos.empty())
    fail(folder.string(),
         others.empty() ? "holds no photo" + passed_over_text(findings)
                        : "holds no photo but in " + others.front().filename().string() +
                              ", a folder that is called after no lamp",
         !others.empty() && lamps.names.size() < 2
             ? "move its photos into " + folder.string() + ", or name the folder that holds them"
         : lamps.names.size() > 1
             ? "put photos into the folders of their lamps: " + lamp_folders_in_words(folder, lamps.names)
             : "give the folder that holds the photos (JPEG, HEIC, PNG, TIFF, EXR or camera raw)");
  // In the camera's order, for any lamp.
  std::stable_sort(photos.begin(), photos.end(),
                   [](const IncomingPhoto& a, const IncomingPhoto& b) { return in_name_order(a.file, b.file); });
  return source_of(std::move(photos), findings);
}

PhotoSource named_source(const std::vector<fs::path>& names, std::vector<Finding>& findings) {
  std::vector<IncomingPhoto> photos;
  for (const fs::path& name : names) {
    std::error_code error;
    std::vector<fs::path> here = {name};
    if (fs::is_directory(name, error)) {
      here = photos_in(name, findings);
      if (here.empty())
        fail(name.string(), "holds no photo" + passed_over_text(findings),
             "give the folder that holds the photos (JPEG, HEIC, PNG, TIFF, EXR or camera raw)");
    } else if (!fs::exists(name, error)) {
      fail(name.string(), "there is no such file or folder", "give photos, or the folder that holds them");
    }
    for (const fs::path& file : here)
      if (std::none_of(photos.begin(), photos.end(),
                       [&](const IncomingPhoto& photo) { return fs::equivalent(photo.file, file, error); }))
        photos.push_back({file, {}, {}, {}});
  }
  return source_of(std::move(photos), findings);
}

}  // namespace burin
