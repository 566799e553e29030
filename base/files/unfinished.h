// burin/base/files/unfinished.h - registry of temporary files and folders of this process. A stopped process removes
// them, and it stops between results, never within one.
//
// A writer calls begin_unfinished() before the first byte and holds making() until the file exists. It holds
// finishing() while it puts a result in its place (all renames of one result), and calls end_unfinished() when the
// temporary name is gone. A program that exits at once calls abandon_unfinished(), which waits for files in creation
// and for renames in progress, blocks new ones, and removes the remaining files.
#pragma once

#include <filesystem>
#include <mutex>
#include <shared_mutex>

namespace burin {

/// Registers a file or folder, which abandon_unfinished() will remove.
void begin_unfinished(const std::filesystem::path& path);

/// Unregisters it: it is in its place, or removed.
void end_unfinished(const std::filesystem::path& path);

/// Lock while a file is named and opened: abandon_unfinished() waits for it, so registered files exist.
std::shared_lock<std::shared_mutex> making();

/// Lock while a result is put in its place: abandon_unfinished() waits for it.
std::unique_lock<std::recursive_mutex> finishing();

/// For an exiting process: removes all unfinished files. Afterwards no other thread gets making() or finishing(), so
/// nothing new appears and no partly removed result is put in place. Ignores files that cannot be removed.
void abandon_unfinished();

/// Calls begin_unfinished() and end_unfinished() for one name.
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
