// tools/loop/lock.h - one loop at a time in a project.
#pragma once

#include <filesystem>
#include <string>

namespace burin {

/// Holds a project while it lives. The lock is the kernel's (flock on PROJECT/.burin-loop.lock): it ends with the
/// process, however that ends, so that a file left behind blocks nobody.
class ProjectLock {
 public:
  /// Throws Error that says who holds the project, and since when, where another process does.
  explicit ProjectLock(const std::filesystem::path& project);
  ~ProjectLock();
  ProjectLock(const ProjectLock&) = delete;
  ProjectLock& operator=(const ProjectLock&) = delete;

 private:
  int file_ = -1;
};

/// "process 4711 since 2025-06-01 10:30:00" of a loop at work there; empty if none is.
std::string loop_at_work(const std::filesystem::path& project);

}  // namespace burin
