#include "tools/standard_streams.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>

#include "burin/base/files/file_error.h"
#include "burin/base/files/printable.h"
#include "burin/base/files/write_file.h"

namespace burin {

void fill_closed_streams() {
  for (int number = 0; number <= STDERR_FILENO; ++number)
    // Opened in the wrong direction, so that its use fails as on a closed stream.
    if (::fcntl(number, F_GETFD) == -1 && errno == EBADF)
      static_cast<void>(::open("/dev/null", number == STDIN_FILENO ? O_WRONLY : O_RDONLY));
}

void tell(std::string_view text) {
  std::fwrite(text.data(), 1, text.size(), stderr);
  std::fflush(stderr);
}

void say_text(std::string_view text) {
  std::string shown;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    shown += printable(text.substr(0, end));
    if (end < text.size()) shown += '\n';
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  std::fwrite(shown.data(), 1, shown.size(), stdout);
}

int exit_code_with_output_checked(int exit_code) {
  errno = 0;
  const bool failed = std::fflush(stdout) != 0 || std::ferror(stdout) != 0;
  const int error = errno;
  if (!failed) return exit_code;
  tell(fmt::format(
      "burin: standard output: the text could not be written{}; {}\n", error == 0 ? "" : ": " + error_text(error),
      error == 0 ? "send it to a file on a disk with room, or to a program that reads it" : error_remedy(error)));
  return exit_code == 0 ? 1 : exit_code;
}

ResultToOutput::ResultToOutput(const std::vector<std::string>& arguments) {
  bool wanted = false;
  for (std::size_t i = 0; i < arguments.size(); ++i)
    wanted = wanted || arguments[i] == "--out=-" ||
             (arguments[i] == "--out" && i + 1 < arguments.size() && arguments[i + 1] == "-");
  if (!wanted) return;
  std::fflush(stdout);
  output_ = ::fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
  ::dup2(STDERR_FILENO, STDOUT_FILENO);
  set_result_output(output_);
}

ResultToOutput::~ResultToOutput() {
  if (output_ < 0) return;
  std::fflush(stdout);
  set_result_output(-1);
  ::dup2(output_, STDOUT_FILENO);
  ::close(output_);
}

}  // namespace burin
