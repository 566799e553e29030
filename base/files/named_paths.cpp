#include "burin/base/files/named_paths.h"

#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <iterator>
#include <mutex>
#include <set>
#include <string_view>
#include <system_error>
#include <utility>

#include "burin/base/error.h"
#include "burin/base/files/file_names.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

// The current folder, then the named paths, absolute and without ".."; empty if nobody has named anything. Set before
// there are threads.
std::vector<fs::path>& named_now() {
  static std::vector<fs::path> paths;
  return paths;
}

// The named paths that are values of output options.
std::vector<fs::path>& outputs_now() {
  static std::vector<fs::path> paths;
  return paths;
}

// Files that this command has read, by device and inode number, and files that it has written or may change, by name.
// Several threads read photos.
struct Traffic {
  std::mutex mutex;
  std::set<std::pair<std::uintmax_t, std::uintmax_t>> read;
  std::set<fs::path> ours, written;
};
Traffic& traffic() {
  static Traffic all;
  return all;
}

void forget_traffic() {
  const std::lock_guard<std::mutex> guard(traffic().mutex);
  traffic().read.clear();
  traffic().ours.clear();
  traffic().written.clear();
}

// One path for all names of a file in one folder.
fs::path real_name(const fs::path& file) {
  std::error_code error;
  const fs::path folder = fs::canonical(file.has_parent_path() ? file.parent_path() : fs::path("."), error);
  return error ? fs::absolute(file, error).lexically_normal() : folder / file.filename();
}

bool same_file(const fs::path& a, const fs::path& b) {
  std::error_code error;
  return fs::equivalent(a, b, error) || real_name(a) == real_name(b);
}

fs::path whole_name(const fs::path& path) {
  std::error_code error;
  const fs::path whole = fs::absolute(path, error).lexically_normal();
  return whole.has_filename() ? whole : whole.parent_path();
}

bool begins_with(const fs::path& path, const fs::path& folder) {
  return std::mismatch(folder.begin(), folder.end(), path.begin(), path.end()).first == folder.end();
}

std::ptrdiff_t steps_of(const fs::path& path) { return std::distance(path.begin(), path.end()); }

// The first symbolic link between `folder` and `file`.
fs::path first_link(const fs::path& file, const fs::path& folder) {
  fs::path at = folder;
  std::error_code error;
  for (auto step = std::next(file.begin(), steps_of(folder)); step != file.end(); ++step)
    if (fs::is_symlink(fs::symlink_status(at /= *step, error))) return at;
  return file;
}

// The innermost project of a folder: the folder itself, or one of the three above it (round-01/session/photos). Empty:
// none.
fs::path project_of(fs::path folder) {
  constexpr int kLevels = 4;
  for (int i = 0; i < kLevels && !folder.empty(); ++i, folder = folder.parent_path()) {
    if (is_project(folder)) return folder;
    if (folder == folder.parent_path()) break;
  }
  return {};
}

struct Magic {
  std::string_view begin, kind;
};
constexpr std::array<Magic, 9> kMagics{{{"%pdf", "a PDF"},
                                        {"\x89png", "a PNG picture"},
                                        {"\xFF\xD8", "a JPEG picture"},
                                        {"v/1\x01", "an EXR picture"},
                                        {"ii*", "a TIFF picture"},
                                        {"mm", "a TIFF picture"},
                                        {"<!doctype html", "a web page"},
                                        {"<html", "a web page"},
                                        {"<", "a drawing"}}};

// The value of "format" in a JSON text; empty: none.
std::string format_of(const std::string& json) {
  constexpr std::string_view kKey = "\"format\"";
  const std::size_t key = json.find(kKey);
  if (key == std::string::npos) return {};
  const std::size_t from = json.find('"', key + kKey.size());
  const std::size_t end = from == std::string::npos ? from : json.find('"', from + 1);
  return end == std::string::npos ? std::string() : json.substr(from + 1, end - from - 1);
}

// A file's kind in words, by its first bytes; empty for an empty or missing file.
std::string kind_of(const fs::path& file) {
  constexpr std::size_t kHead = std::size_t{1} << 16;
  std::string head(kHead, '\0');
  std::ifstream in(file, std::ios::binary);
  in.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(in.gcount()));
  if (head.empty()) return {};
  const std::size_t begin = head.find_first_not_of("\xEF\xBB\xBF \t\r\n");
  const std::string start = lower_case(begin == std::string::npos ? "" : head.substr(begin, 16));
  if (head.find("lensmodel") != std::string::npos) return "a lens model";
  if (start.starts_with('{')) {
    const std::string format = format_of(head);
    return format.empty() ? "a JSON file" : "a JSON file of the format " + format;
  }
  const auto* const magic =
      std::find_if(kMagics.begin(), kMagics.end(), [&](const Magic& m) { return start.starts_with(m.begin); });
  if (magic == kMagics.end()) return head.find('\0') == std::string::npos ? "a text file" : "a file of another kind";
  if (magic->kind != "a web page") return std::string(magic->kind);
  return lower_case(head).find("burin") == std::string::npos ? "a web page of another program" : "a web page";
}

}  // namespace

NamedPaths::NamedPaths(const std::vector<std::string>& words)
    : before_(std::move(named_now())), outputs_before_(std::move(outputs_now())) {
  std::vector<fs::path> now{whole_name(".")}, outputs;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::string& word = words[i];
    const std::size_t from = word.starts_with('-') ? std::min(word.find('='), word.size() - 1) + 1 : 0;
    if (from >= word.size()) continue;
    now.push_back(whole_name(word.substr(from)));
    const std::string option = from > 0 ? word.substr(0, from - 1) : i > 0 ? words[i - 1] : "";
    constexpr std::array<std::string_view, 3> kOutputs{"--out", "--sent", "--animate"};
    if (std::find(kOutputs.begin(), kOutputs.end(), option) != kOutputs.end()) outputs.push_back(now.back());
  }
  named_now() = std::move(now);
  outputs_now() = std::move(outputs);
  forget_traffic();
}

NamedPaths::~NamedPaths() {
  named_now() = std::move(before_);
  outputs_now() = std::move(outputs_before_);
  forget_traffic();
}

void note_input(std::uintmax_t device, std::uintmax_t number) {
  if (outputs_now().empty()) return;
  const std::lock_guard<std::mutex> guard(traffic().mutex);
  traffic().read.emplace(device, number);
}

void allow_change_of(const fs::path& file) {
  if (outputs_now().empty()) return;
  const std::lock_guard<std::mutex> guard(traffic().mutex);
  traffic().ours.insert(real_name(file));
}

void note_written(const fs::path& named) {
  if (named_now().empty()) return;
  const std::lock_guard<std::mutex> guard(traffic().mutex);
  traffic().written.insert(named.lexically_normal());
}

void note_moved(const fs::path& from, const fs::path& to) {
  const fs::path before = from.lexically_normal();
  const std::lock_guard<std::mutex> guard(traffic().mutex);
  std::set<fs::path> now;
  for (const fs::path& file : traffic().written)
    now.insert(begins_with(file, before) ? (to / file.lexically_relative(before)).lexically_normal() : file);
  traffic().written = std::move(now);
}

std::vector<fs::path> written_files() {
  const std::lock_guard<std::mutex> guard(traffic().mutex);
  std::vector<fs::path> out;
  std::error_code gone;
  for (const fs::path& file : traffic().written)
    if (fs::exists(file, gone)) out.push_back(file);
  return out;
}

void fail_if_input(const fs::path& named, const fs::path& file) {
  const std::vector<fs::path>& outputs = outputs_now();
  const fs::path real = real_name(file);
  const auto holds = [&](const fs::path& folder) {
    std::error_code error;
    return begins_with(real, fs::weakly_canonical(folder, error));
  };
  const auto concerns = [&](const fs::path& out) { return holds(out) || holds(out.parent_path()); };
  if (std::none_of(outputs.begin(), outputs.end(), concerns)) return;
  const std::lock_guard<std::mutex> guard(traffic().mutex);
  if (traffic().ours.contains(real)) return;
  const auto is_file = [&](const fs::path& path) { return same_file(path, file); };
  struct stat found {};
  const bool was_read = ::stat(file.c_str(), &found) == 0 && traffic().read.contains({found.st_dev, found.st_ino});
  const bool twice = std::any_of(outputs.begin(), outputs.end(), is_file) &&
                     std::count_if(named_now().begin(), named_now().end(), is_file) > 1;
  if (!was_read && !twice) return;
  fail(named.string(),
       was_read ? "is an input of this command, and its output would replace it"
                : "is named twice on the command line, and is to be written",
       "give the output another name");
}

void fail_if_other_kind(const fs::path& named, const fs::path& file, const fs::path& part) {
  const std::vector<fs::path>& outputs = outputs_now();
  if (std::none_of(outputs.begin(), outputs.end(), [&](const fs::path& out) { return same_file(out, file); })) return;
  {
    const std::lock_guard<std::mutex> guard(traffic().mutex);
    if (traffic().ours.contains(real_name(file))) return;
  }
  const std::string there = kind_of(file), now = kind_of(part);
  if (there.empty() || there == now) return;
  fail(named.string(), "is " + there + ", and " + now + " would replace it",
       "give the output another name, or remove that file");
}

void fail_if_led_outside(const fs::path& named, const fs::path& real) {
  if (named_now().empty()) return;
  const fs::path whole = whole_name(named);
  // Files next to a named file may be written, too. If nobody named a folder above it, the file stays in its own
  // folder.
  fs::path within;
  for (const fs::path& path : named_now()) {
    if (begins_with(path, whole)) return;  // or `named` is above a named path
    for (const fs::path& folder : {path, path.parent_path()})
      if (folder != whole && begins_with(whole, folder) && steps_of(folder) > steps_of(within)) within = folder;
  }
  if (within.empty()) within = whole.parent_path();
  std::error_code error;
  const fs::path home = fs::weakly_canonical(within, error);
  if (!error && begins_with(real, home)) return;
  const fs::path link = first_link(whole, within);
  fail(named.string(),
       "is not written: the symbolic link " + link.string() + " leads out of " + within.string() + ", to " +
           real.string(),
       "remove that link if you did not make it; files are written elsewhere only where the command line names them "
       "by their own path (--out FILE)");
}

bool is_project(const fs::path& folder) {
  std::error_code error;
  return fs::is_regular_file(folder / "design.json", error) && fs::is_regular_file(folder / "board.json", error);
}

bool may_change_in(const fs::path& folder, const fs::path& file) {
  const fs::path in = whole_name(folder), whole = whole_name(file);
  const auto is_within_project_of = [&](const fs::path& named) {
    const fs::path project = project_of(named);
    return !project.empty() && begins_with(in, project);
  };
  if (named_now().empty()) return in == whole.parent_path() || is_within_project_of(whole.parent_path());
  std::error_code error;
  // The first entry is the current folder, which nobody has named.
  return std::any_of(std::next(named_now().begin()), named_now().end(), [&](const fs::path& named) {
    if (named == whole && in == whole.parent_path()) return true;
    if (!fs::exists(named, error)) return false;  // an option's value, a command's name
    const bool is_folder = fs::is_directory(named, error);
    return (is_folder && begins_with(in, named)) || is_within_project_of(is_folder ? named : named.parent_path());
  });
}

}  // namespace burin
