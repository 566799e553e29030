#include "tools/studio/studio_names.h"

#include <sys/random.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "burin/base/error.h"
#include "burin/base/files/file_names.h"
#include "burin/base/files/printable.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

// Pictures and photos; the content decides later, these only keep other files away.
const std::set<std::string> kPictureEndings{
    ".png", ".jpg", ".jpeg", ".tif", ".tiff", ".exr", ".hdr", ".heic", ".heif", ".avif", ".webp", ".bmp", ".gif",
    ".ppm", ".pgm", ".pnm",  ".dng", ".cr2",  ".cr3", ".nef", ".arw",  ".raf",  ".orf",  ".rw2",  ".pef"};

}  // namespace

std::string upload_name(const std::string& given) {
  const std::size_t slash = given.find_last_of("/\\");
  const std::string last = slash == std::string::npos ? given : given.substr(slash + 1);
  const std::string ending = lower_extension(last);
  if (!kPictureEndings.contains(ending))
    fail("the file " + printable(last), "has no name of a picture", "send a photo or a picture, such as cat.jpg");
  std::string stem = file_name_of(last.substr(0, last.size() - ending.size()));
  if (stem.empty()) stem = "picture";
  return stem + ending;
}

fs::path free_name(const fs::path& folder, const std::string& name) {
  const fs::path given(name);
  std::error_code ignored;
  fs::path file = folder / given;
  for (int i = 2; fs::exists(fs::symlink_status(file, ignored)); ++i)
    file = folder / (given.stem().string() + "-" + std::to_string(i) + given.extension().string());
  return file;
}

fs::path confined(const fs::path& folder, const std::string& path) {
  const auto refuse = [&](const char* what) { fail(printable(path), what, "name a file of the opened project"); };
  if (path.empty() || path.size() > 1000 || !is_printable(path)) refuse("is no name of a file");
  for (const fs::path& part : fs::path(path))
    if (part.string().starts_with(".") || part.is_absolute()) refuse("leads out of the folder, or is hidden");
  std::error_code error;
  const fs::path root = fs::canonical(folder, error);
  const fs::path file = error ? fs::path() : fs::canonical(root / path, error);
  if (error) refuse("is not there");
  const auto [end, ignored] = std::mismatch(root.begin(), root.end(), file.begin(), file.end());
  if (end != root.end()) refuse("leads out of the folder");
  if (!fs::is_regular_file(file, error)) refuse("is no plain file");
  return file;
}

std::string plain_value(const Json& json, const std::string& key) {
  if (!json.contains(key) || json[key].is_null()) return {};
  constexpr std::size_t kLongest = 60;
  if (!json[key].is_string()) fail(key, "is no text", "give a short text");
  const auto text = json[key].get<std::string>();
  const bool plain = text.size() <= kLongest && std::all_of(text.begin(), text.end(), [](unsigned char c) {
                       return std::isalnum(c) != 0 ||
                              std::string_view(" .,:+_/-").find(static_cast<char>(c)) != std::string_view::npos;
                     });
  if (!plain)
    fail(key, "\"" + printable(text.substr(0, kLongest)) + "\" has characters that no such value has",
         "use letters, digits and units");
  return text;
}

double number_within(const Json& json, const std::string& key, double least, double most) {
  if (!json.contains(key) || !json[key].is_number()) fail(key, "is no number", "give a number");
  const auto value = json[key].get<double>();
  if (!(value >= least && value <= most))
    fail(key, "lies outside of its limits", fmt::format("give a number from {:g} to {:g}", least, most));
  return value;
}

std::string media_type(const fs::path& file) {
  static const std::array<std::pair<const char*, const char*>, 12> kTypes{{{".png", "image/png"},
                                                                           {".jpg", "image/jpeg"},
                                                                           {".jpeg", "image/jpeg"},
                                                                           {".webp", "image/webp"},
                                                                           {".gif", "image/gif"},
                                                                           {".svg", "image/svg+xml"},
                                                                           {".html", "text/html; charset=utf-8"},
                                                                           {".pdf", "application/pdf"},
                                                                           {".gcode", "text/plain; charset=utf-8"},
                                                                           {".csv", "text/plain; charset=utf-8"},
                                                                           {".json", "application/json"},
                                                                           {".toml", "text/plain; charset=utf-8"}}};
  const std::string ending = lower_extension(file);
  for (const auto& [known, type] : kTypes)
    if (ending == known) return type;
  return {};
}

std::string random_token() {
  std::array<unsigned char, 24> bytes{};
  std::size_t have = 0;
  while (have < bytes.size()) {
    const ssize_t n = ::getrandom(bytes.data() + have, bytes.size() - have, 0);
    if (n > 0) have += static_cast<std::size_t>(n);
  }
  std::string text;
  for (const unsigned char byte : bytes) text += fmt::format("{:02x}", byte);
  return text;
}

bool same_secret(const std::string& a, const std::string& b) {
  if (a.size() != b.size() || a.empty()) return false;
  unsigned differs = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    differs |= static_cast<unsigned>(static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(b[i]));
  return differs == 0;
}

}  // namespace burin
