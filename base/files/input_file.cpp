#include "burin/base/files/input_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <limits>
#include <utility>

#include "burin/base/error.h"
#include "burin/base/files/descriptor.h"
#include "burin/base/files/files_together.h"
#include "burin/base/files/named_paths.h"
#include "burin/base/input_error.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail_to_open(const fs::path& file, int error) {
  const std::string name = file.string();
  switch (error) {
    case ENOENT:
      fail_as(ErrorCode::missing_file, name, "does not exist", "check the path");
    case ENOTDIR:
      fail_as(ErrorCode::missing_file, name, "does not exist: a part of its path is a file, not a folder",
              "check the path");
    case EACCES:
    case EPERM:
      fail_as(ErrorCode::unreadable_file, name, "may not be read",
              "give yourself the right to read it and to enter its folder (chmod u+r, chmod u+rx)");
    case ELOOP:
      fail_as(ErrorCode::unreadable_file, name, "is a link that leads in a circle",
              "remove the link, or let it lead to the file");
    case ENAMETOOLONG:
      fail_as(ErrorCode::unreadable_file, fs::path(name.substr(0, 60) + "...").string(),
              "has a name that is longer than the file system allows",
              "shorten it to 255 bytes, and its whole path to 4,095");
    case EMFILE:
    case ENFILE:
      fail_as(ErrorCode::unreadable_file, name, "cannot be opened: too many files are open",
              "close other programs, or raise ulimit -n");
    case ENXIO:
    case ENODEV:
      fail_as(ErrorCode::unreadable_file, name, "is a socket or a device", "name a plain file");
    default:
      fail_as(ErrorCode::unreadable_file, name, std::string("cannot be opened: ") + std::strerror(error),
              "check the disk and the path");
  }
}

/// An open plain file and its size. `is_input`: it is read for its content, so no output may replace it.
std::pair<Descriptor, std::uintmax_t> open_plain(const fs::path& file, bool is_input = true) {
  const std::string name = file.string();
  if (name.empty()) fail("the name of a file", "is empty", "name a file");
  if (name.find('\0') != std::string::npos)
    fail(name.substr(0, name.find('\0')), "has a zero byte in its name, which no file has", "correct the name");
  settle_changes(file);  // readers must not see an interrupted change
  // O_NONBLOCK: a FIFO without a writer would block forever.
  Descriptor open(::open(name.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC | O_NOCTTY));
  if (!open) fail_to_open(file, errno);
  struct stat status {};
  const bool known = ::fstat(open.number(), &status) == 0;
  const char* instead = nullptr;
  if (known && S_ISDIR(status.st_mode))
    instead = "is a folder";
  else if (known && S_ISFIFO(status.st_mode))
    instead = "is a FIFO (a pipe with a name), not a file";
  else if (!known || !S_ISREG(status.st_mode))
    instead = "is a device, not a file";
  if (instead != nullptr) {
    const bool folder = known && S_ISDIR(status.st_mode);
    fail(name, instead, folder ? "name a file in it" : "write what it gives into a file, and name that");
  }
  if (is_input) note_input(status.st_dev, status.st_ino);
  return {std::move(open), static_cast<std::uintmax_t>(status.st_size)};
}

void require_size(const fs::path& file, std::uintmax_t bytes, std::uintmax_t most, const std::string& kind) {
  if (bytes > most)
    fail(file.string(),
         "has " + bytes_text(bytes) + ", more than the " + bytes_text(most) + " that Burin reads of " + kind,
         "check that it is the right file, and split it or make it smaller (docs/limits.md)");
}

std::string read_so_many(const fs::path& file, int number, std::uintmax_t bytes) {
  std::string text(bytes, '\0');
  std::size_t have = 0;
  while (have < text.size()) {
    const ssize_t got = ::read(number, text.data() + have, text.size() - have);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0)
      fail_as(ErrorCode::unreadable_file, file.string(), std::string("cannot be read: ") + std::strerror(errno),
              "check the disk it lies on");
    if (got == 0)
      fail_as(ErrorCode::unreadable_file, file.string(), "became shorter while it was read",
              "wait until it is written, and try again");
    have += static_cast<std::size_t>(got);
  }
  return text;
}

}  // namespace

std::uintmax_t require_plain_file(const fs::path& file, std::uintmax_t most_bytes, const std::string& kind) {
  const std::uintmax_t bytes = open_plain(file).second;
  require_size(file, bytes, most_bytes, kind);
  return bytes;
}

std::string read_bytes(const fs::path& file, std::uintmax_t most_bytes, const std::string& kind) {
  const auto [open, bytes] = open_plain(file);
  require_size(file, bytes, most_bytes, kind);
  return read_so_many(file, open.number(), bytes);
}

std::string read_head(const fs::path& file, std::uintmax_t bytes) {
  const auto [open, size] = open_plain(file, false);
  return read_so_many(file, open.number(), std::min(bytes, size));
}

void require_at_most(std::size_t count, std::size_t most, const std::string& where, const std::string& things,
                     const std::string& remedy) {
  if (count > most)
    fail(where,
         "has " + with_commas(count) + " " + things + ", more than the " + with_commas(most) + " that Burin takes",
         remedy + " (docs/limits.md)");
}

std::string with_commas(std::uintmax_t number) {
  std::string text = std::to_string(number);
  for (std::size_t at = text.size(); at > 3;) text.insert(at -= 3, ",");
  return text;
}

std::string bytes_text(std::uintmax_t bytes) {
  constexpr std::uintmax_t kMega = 1'000'000;
  if (bytes < 10 * kMega) return with_commas(bytes) + " bytes";
  return with_commas((bytes + kMega / 2) / kMega) + " MB";
}

}  // namespace burin
