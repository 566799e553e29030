#include "burin/base/files/unfinished.h"

#include <set>
#include <system_error>
#include <utility>

namespace burin {
namespace {

namespace fs = std::filesystem;

struct Names {
  std::mutex mutex;
  std::set<fs::path> paths;
  std::shared_mutex making;
  std::recursive_mutex finishing;
};

Names& names() {
  // Never destroyed: a signal may stop an exiting process.
  static Names& all = *new Names;
  return all;
}

}  // namespace

void begin_unfinished(const fs::path& path) {
  // The current folder may have changed by then.
  std::error_code error;
  const fs::path whole = fs::absolute(path, error);
  const std::lock_guard lock(names().mutex);
  names().paths.insert(error ? path : whole);
}

void end_unfinished(const fs::path& path) {
  std::error_code error;
  const fs::path whole = fs::absolute(path, error);
  const std::lock_guard lock(names().mutex);
  names().paths.erase(error ? path : whole);
}

std::shared_lock<std::shared_mutex> making() { return std::shared_lock(names().making); }

std::unique_lock<std::recursive_mutex> finishing() { return std::unique_lock(names().finishing); }

void abandon_unfinished() {
  names().finishing.lock();  // and never unlocked
  names().making.lock();
  std::set<fs::path> paths;
  {
    const std::lock_guard lock(names().mutex);
    paths = names().paths;
  }
  std::error_code error;
  // Another thread may create folders within one during its removal: a second pass finds them.
  for (int i = 0; i < 2; ++i)
    for (const fs::path& path : paths) fs::remove_all(path, error);
}

Unfinished::Unfinished(fs::path path) : path_(std::move(path)) { begin_unfinished(path_); }

Unfinished::~Unfinished() { end_unfinished(path_); }

}  // namespace burin
