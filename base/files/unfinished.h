// burin/base/files/unfinished.h - the files and folders that this process is making under names for a while, so that
// a process that is told to stop takes them away, and stops between results, never within one.
//
// Whoever writes says begin_unfinished() before the first byte, holds making() from before that until the file is
// there, holds finishing() while a result is put in its place (all renames of what belongs together), and says
// end_unfinished() when the name is gone. A program that ends at once calls abandon_unfinished(): files that are being
// made and renames that have begun are waited for, none begins any more, and what is left is removed.
#pragma once

#include <filesystem>
#include <mutex>
#include <shared_mutex>

namespace burin {

/// From now on this file or folder is removed by abandon_unfinished().
void begin_unfinished(const std::filesystem::path& path);

/// It is in its place, or removed.
void end_unfinished(const std::filesystem::path& path);

/// Held while a file is named and opened: abandon_unfinished() waits for it, so that what it knows is there.
std::shared_lock<std::shared_mutex> making();

/// Held while a result is put in its place: abandon_unfinished() waits for it.
std::unique_lock<std::recursive_mutex> finishing();

/// For a process that ends now: removes all that is unfinished. No other thread gets making() or finishing() from then
/// on, so that nothing comes after it and nothing half removed is put in place. Says nothing of what cannot be removed.
void abandon_unfinished();

/// begin_unfinished() and end_unfinished() of one name.
class Unfinished {
 public:
  explicit Unfinished(std::filesystem::path path);
  ~Unfinished();
  Unfinished(const Unfinished&) = delete;
  Unfinished& operator=(const Unfinished&) = delete;

 private:
  std::filesystem::path path_;
};

}  // namespace burin
