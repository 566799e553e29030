// tools/work_lock.h - one command at a time where results are made: the loop and every command that writes a project's.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace burin {

/// Where a command that writes into `folder` must be alone: the project, if the folder is one or lies in a round of one
/// (PROJECT/round-01/design), otherwise the folder itself. A project has design.json and board.json.
std::filesystem::path locked_folder(const std::filesystem::path& folder);

/// Holds locked_folder() while it lives. The lock is the kernel's (flock on FOLDER/.burin-lock): it ends with the
/// process, however that ends, so that a file left behind blocks nobody. A process may hold one several times: the loop
/// runs its steps within it.
class WorkLock {
 public:
  /// Commands that write one file into a folder that is no project's keep nobody from writing another one there.
  /// A new folder is made where there is none yet, and goes again if nothing has come to lie in it.
  enum class Where { all_folders, new_folders, projects };

  /// Throws Error that says who works there, at what and since when, where another process does. `work` says that of
  /// this one: "burin design". Where a folder cannot be written to, nothing can be made there: Error, too.
  WorkLock(const std::filesystem::path& folder, const std::string& work, Where where = Where::all_folders);
  ~WorkLock();
  WorkLock(const WorkLock&) = delete;
  WorkLock& operator=(const WorkLock&) = delete;

 private:
  std::string key_;
  std::vector<std::filesystem::path> made_;
};

/// "burin loop my-board, process 4711 since 2025-06-01 10:30:00" of who is at work there; empty if nobody is.
std::string who_works_in(const std::filesystem::path& folder);

}  // namespace burin
