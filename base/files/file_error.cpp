#include "burin/base/files/file_error.h"

#include <cerrno>
#include <system_error>

#include "burin/base/error.h"
#include "burin/base/input_error.h"

namespace burin {

std::string error_text(int error) { return std::generic_category().message(error); }

std::string error_remedy(int error) {
  switch (error) {
    case ENOSPC:
    case EDQUOT:
      return "make room on the disk, or write to another one";
    case EFBIG:
      return "write to a disk that takes files of that size";
    case EIO:
      return "check the disk: it reports errors";
    case EACCES:
    case EPERM:
      return "get the right to it (chmod, chown), or choose a place that is yours";
    case EROFS:
      return "choose a disk that can be written to";
    case ENAMETOOLONG:
      return "choose shorter names: the system takes 255 bytes for each, and 4095 for all of a path";
    case ELOOP:
      return "mend the symbolic links: they lead round in a circle";
    case EBADF:
      return "it is closed: leave it open (no `>&-`), or send it to a file";
    case ENOENT:
      return "choose a folder that exists and that you may write to";
    case ENOTDIR:
      return "one of the folders in this path is a file: correct the path";
    case EMFILE:
    case ENFILE:
      return "too many files are open: raise the limit (ulimit -n), or end other programs";
    case EAGAIN:
      return "raise the limit on processes and threads (ulimit -u), or end other programs";
    case EPIPE:
      return "send it to a program that reads all of it, or to a file";
    case ENOMEM:
      return "end other programs, or use a machine with more memory";
    default:
      return "choose a folder that exists and that you may write to, and check its disk";
  }
}

void fail_with(const std::filesystem::path& file, const std::string& what, int error) {
  fail_as(ErrorCode::not_written, file.string(), what + ": " + error_text(error), error_remedy(error));
}

void fail_unless_name(const std::filesystem::path& file) {
  const std::string& name = file.native();
  if (const std::size_t zero = name.find('\0'); zero != std::string::npos)
    fail(name.substr(0, zero), "is a name with a zero byte behind it", "write the name without \\u0000");
  if (file.filename().empty()) fail(file.string(), "names no file", "add a file name");
}

}  // namespace burin
