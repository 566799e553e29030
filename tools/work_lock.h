// tools/work_lock.h - lock against simultaneous commands in one project: the loop and every command that writes its
// results.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace burin {

/// Returns the folder that a command with output in `folder` locks. It is the project for a project folder or a folder
/// in one of its rounds (PROJECT/round-01/design), otherwise the folder itself. A project has design.json and
/// board.json.
std::filesystem::path locked_folder(const std::filesystem::path& folder);

/// Holds the lock on locked_folder() during its lifetime. The kernel's lock (flock on FOLDER/.burin-lock) ends with the
/// process in every case, so a leftover file blocks nobody. A process may hold a lock several times: the loop runs its
/// steps within it.
class WorkLock {
 public:
  /// Folders to lock. Commands that write one file outside of projects do not exclude each other. The constructor makes
  /// a missing folder; the destructor removes it if it is empty.
  enum class Where { all_folders, new_folders, projects };

  /// Throws Error if another process holds the lock; the message has its work and start time. `work` describes this
  /// process: "burin design". Throws Error for a folder without write permission.
  WorkLock(const std::filesystem::path& folder, const std::string& work, Where where = Where::all_folders);
  ~WorkLock();
  WorkLock(const WorkLock&) = delete;
  WorkLock& operator=(const WorkLock&) = delete;

 private:
  std::string key_;
  std::vector<std::filesystem::path> made_;
};

/// Returns "burin loop my-board, process 4711 since 2025-06-01 10:30:00" for the holder of the lock; empty if there is
/// none.
std::string who_works_in(const std::filesystem::path& folder);

}  // namespace burin
