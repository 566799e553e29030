#include "tools/loop/lock.h"

#include <fcntl.h>
#include <fmt/chrono.h>
#include <sys/file.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <ctime>

#include "burin/render/error.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

fs::path lock_file(const fs::path& project) { return project / ".burin-loop.lock"; }

// What the holder wrote; it may be writing it just now.
std::string holder(int file) {
  std::array<char, 200> text{};
  const ssize_t length = ::pread(file, text.data(), text.size(), 0);
  const std::string said = length > 0 ? std::string(text.data(), static_cast<std::size_t>(length)) : "";
  return said.empty() ? "another process" : said.substr(0, said.find('\n'));
}

}  // namespace

ProjectLock::ProjectLock(const fs::path& project) {
  const fs::path name = lock_file(project);
  file_ = ::open(name.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (file_ < 0)
    fail(name.string(), fmt::format("cannot be written ({})", std::strerror(errno)),
         "name a project folder that is there and that you may write to");
  if (::flock(file_, LOCK_EX | LOCK_NB) != 0) {
    const int error = errno;
    const std::string who = error == EWOULDBLOCK ? holder(file_) : "";
    ::close(file_);
    if (error != EWOULDBLOCK)
      fail(name.string(), fmt::format("cannot be locked ({})", std::strerror(error)),
           "keep the project on a disk that knows locks");
    fail(project.string(), "a loop is at work here: " + who, "wait until it has ended, or stop it");
  }
  const std::string text =
      fmt::format("process {} since {:%Y-%m-%d %H:%M:%S}\n", ::getpid(), fmt::localtime(std::time(nullptr)));
  // It only tells the other one who is here; the lock holds without it.
  if (::ftruncate(file_, 0) != 0 || ::pwrite(file_, text.data(), text.size(), 0) < 0) return;
}

ProjectLock::~ProjectLock() {
  // Not removed: another process may hold the same file open already, and would then lock a file that nobody sees.
  ::close(file_);
}

std::string loop_at_work(const fs::path& project) {
  const int file = ::open(lock_file(project).c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) return "";
  std::string who;
  if (::flock(file, LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK) who = holder(file);
  ::close(file);
  return who;
}

}  // namespace burin
