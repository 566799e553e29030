#include "burin/render/files/named_paths.h"

#include <algorithm>
#include <iterator>
#include <system_error>
#include <utility>

#include "burin/render/error.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

// What was named, whole and without "..", and the folder that is current; empty while nobody has named anything. Set
// before there are threads.
std::vector<fs::path>& named_now() {
  static std::vector<fs::path> paths;
  return paths;
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

// The first link on the way from `folder` to `file`.
fs::path first_link(const fs::path& file, const fs::path& folder) {
  fs::path at = folder;
  std::error_code error;
  for (auto step = std::next(file.begin(), steps_of(folder)); step != file.end(); ++step)
    if (fs::is_symlink(fs::symlink_status(at /= *step, error))) return at;
  return file;
}

// The innermost project that a folder belongs to: it itself, or one of the three above it (round-01/session/photos).
// Empty: none.
fs::path project_of(fs::path folder) {
  constexpr int kLevels = 4;
  for (int i = 0; i < kLevels && !folder.empty(); ++i, folder = folder.parent_path()) {
    if (is_project(folder)) return folder;
    if (folder == folder.parent_path()) break;
  }
  return {};
}

}  // namespace

NamedPaths::NamedPaths(const std::vector<std::string>& words) : before_(std::move(named_now())) {
  std::vector<fs::path> now{whole_name(".")};
  for (const std::string& word : words) {
    // --out=FILE
    const std::size_t from = word.starts_with('-') ? std::min(word.find('='), word.size() - 1) + 1 : 0;
    if (from < word.size()) now.push_back(whole_name(word.substr(from)));
  }
  named_now() = std::move(now);
}

NamedPaths::~NamedPaths() { named_now() = std::move(before_); }

void fail_if_led_outside(const fs::path& named, const fs::path& real) {
  if (named_now().empty()) return;
  const fs::path whole = whole_name(named);
  // Beside a file that was named, too; where nothing was, what lies in its folder stays there.
  fs::path within;
  for (const fs::path& path : named_now()) {
    if (begins_with(path, whole)) return;  // or is on the way to what was named
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
  // The first is the folder that is current, which nobody has named.
  return std::any_of(std::next(named_now().begin()), named_now().end(), [&](const fs::path& named) {
    if (named == whole && in == whole.parent_path()) return true;
    if (!fs::exists(named, error)) return false;  // an option's value, a command's name
    const bool is_folder = fs::is_directory(named, error);
    return (is_folder && begins_with(in, named)) || is_within_project_of(is_folder ? named : named.parent_path());
  });
}

}  // namespace burin
