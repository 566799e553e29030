#include "tools/work_lock.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <map>
#include <mutex>
#include <thread>
#include <utility>

#include "burin/base/error.h"
#include "burin/base/files/descriptor.h"
#include "burin/base/files/file_error.h"
#include "burin/base/files/json_file.h"
#include "burin/base/files/named_paths.h"
#include "burin/base/input_error.h"
#include "tools/local_time.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

// Locks of this process by real folder name: flock treats each opened file as another holder.
struct Held {
  Descriptor file;
  int times = 0;
  fs::path name;
};

struct AllHeld {
  std::mutex mutex;
  std::map<std::string, Held> by_folder;
};

AllHeld& all_held() {
  static AllHeld all;
  return all;
}

fs::path lock_file(const fs::path& folder) { return folder / ".burin-lock"; }

// Returns the holder's text; it may still be incomplete.
std::string said_by_holder(int file) {
  std::array<char, 400> text{};
  const ssize_t length = ::pread(file, text.data(), text.size(), 0);
  const std::string said = length > 0 ? std::string(text.data(), static_cast<std::size_t>(length)) : "";
  return said.substr(0, said.find('\n'));
}

std::string holder(int file) {
  const std::string said = said_by_holder(file);
  return said.empty() ? "another process" : said;
}

// Locks a file unless another process works there. A holder without text has just begun, or is only asking
// (who_works_in): waits for it briefly.
bool lock_soon(int file) {
  constexpr int kTries = 50;
  constexpr std::chrono::milliseconds kBetween(10);
  for (int i = 0; ::flock(file, LOCK_EX | LOCK_NB) != 0; ++i) {
    const int error = errno;
    if (error != EWOULDBLOCK || i == kTries || !said_by_holder(file).empty()) {
      errno = error;
      return false;
    }
    std::this_thread::sleep_for(kBetween);
  }
  return true;
}

bool is_round(const std::string& name) {
  constexpr std::string_view kRound = "round-";
  return name.starts_with(kRound) && name.size() > kRound.size() &&
         name.find_first_not_of("0123456789", kRound.size()) == std::string::npos;
}

// Returns the locked file; none if its holder has removed it since it was opened.
Descriptor locked_file(const fs::path& name, const fs::path& folder) {
  Descriptor file(::open(name.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0666));
  if (!file) fail_with(name, "cannot be written, and without it two commands could spoil each other's results", errno);
  if (!lock_soon(file.number())) {
    const int error = errno;
    if (error == EWOULDBLOCK)
      fail_as(ErrorCode::locked, folder.string(), "is being worked on by " + holder(file.number()),
              "wait until that has ended, or stop it");
    ::unlink(name.c_str());
    fail(name.string(), "cannot be locked: " + error_text(error), "keep the project on a disk that knows locks");
  }
  return is_at(file.number(), name) ? std::move(file) : Descriptor();
}

// Returns the missing ones of the folder and its parents, the deepest first.
std::vector<fs::path> missing_folders(fs::path folder) {
  std::vector<fs::path> missing;
  std::error_code error;
  for (; !folder.empty() && !fs::exists(folder, error); folder = folder.parent_path()) missing.push_back(folder);
  return missing;
}

void remove_if_empty(const std::vector<fs::path>& folders) {
  std::error_code not_empty;
  for (const fs::path& folder : folders) fs::remove(folder, not_empty);
}

}  // namespace

fs::path locked_folder(const fs::path& folder) {
  std::error_code error;
  fs::path at = fs::weakly_canonical(folder.empty() ? fs::path(".") : folder, error);
  if (error) at = fs::absolute(folder).lexically_normal();
  if (!at.has_filename()) at = at.parent_path();
  if (is_round(at.filename().string()) && is_project(at.parent_path())) return at.parent_path();
  constexpr int kDeepest = 3;  // round-01/design/...
  fs::path up = at;
  for (int i = 0; i < kDeepest && up != up.parent_path(); ++i, up = up.parent_path())
    if (is_round(up.filename().string()) && is_project(up.parent_path())) return up.parent_path();
  return at;
}

WorkLock::WorkLock(const fs::path& folder, const std::string& work, Where where) {
  const fs::path place = locked_folder(folder);
  if (where == Where::new_folders) {
    made_ = missing_folders(fs::absolute(folder).lexically_normal());
    make_output_folder(folder);
  }
  std::error_code error;
  if (!fs::is_directory(place, error)) return;  // nobody can work there; the writer reports it
  if (where == Where::projects && !is_project(place)) return;
  key_ = place.native();
  const std::lock_guard<std::mutex> guard(all_held().mutex);
  Held& held = all_held().by_folder[key_];
  if (held.times > 0) {
    ++held.times;
    return;
  }
  const fs::path name = lock_file(place);
  Descriptor file;
  try {
    while (!file) file = locked_file(name, folder);
  } catch (...) {
    all_held().by_folder.erase(key_);
    remove_if_empty(made_);
    throw;
  }
  held = {std::move(file), 1, name};
  const std::string text = fmt::format("{}, process {} since {}\n", work, ::getpid(), local_time("%Y-%m-%d %H:%M:%S"));
  // The text only informs other processes; the lock holds without it.
  if (::ftruncate(held.file.number(), 0) != 0 || ::pwrite(held.file.number(), text.data(), text.size(), 0) < 0) return;
}

WorkLock::~WorkLock() {
  if (key_.empty()) return;
  const std::lock_guard<std::mutex> guard(all_held().mutex);
  const auto found = all_held().by_folder.find(key_);
  if (found == all_held().by_folder.end() || --found->second.times > 0) return;
  // Removed while locked: a process that has it open detects this (locked_file) and makes a new one.
  ::unlink(found->second.name.c_str());
  all_held().by_folder.erase(found);
  remove_if_empty(made_);
}

std::string who_works_in(const fs::path& folder) {
  const Descriptor file(
      ::open(lock_file(locked_folder(folder)).c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK));
  const bool is_held = file && ::flock(file.number(), LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  return is_held ? holder(file.number()) : "";
}

}  // namespace burin
