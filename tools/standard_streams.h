// tools/standard_streams.h - standard input, output and error: open from the start, checked at the end.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace burin {

/// Opens a substitute for each closed standard stream (`burin ... >&-`). Otherwise the next opened file would get its
/// number, and messages would end up in this file.
void fill_closed_streams();

/// Writes to standard error. Ignores errors, since a closed or full stream leaves no other place for a message.
void tell(std::string_view text);

/// Writes to standard output, with control characters except line breaks as \xNN. exit_code_with_output_checked()
/// reports errors at the end, so that they do not interrupt the command's work.
void say_text(std::string_view text);

/// Flushes standard output. Returns the given exit code, or 1 with a sentence on standard error if output was lost (a
/// full disk behind `>`). A script must not mistake lost output for a result.
int exit_code_with_output_checked(int exit_code);

/// Handles --out "-" during its lifetime: the file goes to standard output (burin/base/files/write_file.h), and
/// messages go to standard error.
class ResultToOutput {
 public:
  explicit ResultToOutput(const std::vector<std::string>& arguments);
  ~ResultToOutput();
  ResultToOutput(const ResultToOutput&) = delete;
  ResultToOutput& operator=(const ResultToOutput&) = delete;

 private:
  int output_ = -1;
};

}  // namespace burin
