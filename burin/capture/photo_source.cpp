#include "burin/capture/photo_source.h"

#include <algorithm>
#include <cctype>
#include <map>
#include <memory>
#include <string_view>
#include <utility>

#include "burin/render/error.h"
#include "burin/render/files/printable.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

// Numbers within names count as numbers.
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

}  // namespace

bool in_name_order(const fs::path& a, const fs::path& b) {
  return natural_less(a.filename().string(), b.filename().string());
}

PhotoSource folder_source(const fs::path& folder, std::vector<Finding>& findings) {
  std::error_code error;
  if (!fs::is_directory(folder, error))
    fail(folder.string(), "there is no such folder", "give the folder that holds the photos");
  std::vector<fs::path> files;
  fs::directory_iterator entries(folder, error);
  if (error) fail(folder.string(), "cannot be read (" + error.message() + ")", "give yourself the right to read it");
  std::map<std::string, fs::path> raw_of;  // by stem
  for (const fs::directory_entry& entry : entries) {
    const std::string name = entry.path().filename().string();
    if (name.front() == '.' || !entry.is_regular_file(error)) continue;
    if (!is_printable(name)) {
      findings.push_back({Finding::Severity::warning, entry.path(),
                          "was passed over: its name holds bytes that are no text", "rename the file"});
      continue;
    }
    if (!is_photo_name(entry.path())) {
      findings.push_back({Finding::Severity::note, entry.path(), "is no photo and was passed over", ""});
      continue;
    }
    if (is_raw_name(entry.path())) raw_of[entry.path().stem().string()] = entry.path();
    files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end(), in_name_order);
  std::erase_if(files, [&](const fs::path& file) {
    const auto raw = raw_of.find(file.stem().string());
    if (raw == raw_of.end() || is_raw_name(file)) return false;
    findings.push_back({Finding::Severity::note, file, "was passed over for " + raw->second.filename().string(), ""});
    return true;
  });
  if (files.empty())
    fail(folder.string(), "holds no photo",
         "give the folder that holds the photos (JPEG, HEIC, PNG, TIFF, EXR or camera raw)");

  const auto list = std::make_shared<const std::vector<fs::path>>(std::move(files));
  return [list, next = std::size_t{0}]() mutable -> std::optional<IncomingPhoto> {
    if (next == list->size()) return std::nullopt;
    IncomingPhoto photo{(*list)[next++], {}, {}};
    try {
      photo.exif = read_exif(photo.file);
    } catch (const Error& unreadable) {
      photo.unreadable = unreadable.what();
    }
    return photo;
  };
}

}  // namespace burin
