// tools/standard_streams.h - standard input, output and error: there from the beginning, and checked at the end.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace burin {

/// Where one of the three was closed (`burin ... >&-`), the next file that is opened would take its number, and what is
/// said would go into that file: a stream that cannot be used takes its place.
void fill_closed_streams();

/// Writes to standard error. Where it is closed or full nobody can be told, and nothing else fails by that.
void tell(std::string_view text);

/// Writes to standard output, with what a terminal would obey instead of showing it as \xNN; line breaks stay. Errors
/// are told at the end (exit_code_with_output_checked), so that nothing a command still has to do is lost by them.
void say_text(std::string_view text);

/// Flushes standard output. The exit code as it was, or 1 with a sentence on standard error where what was said could
/// not be written (a full disk behind `>`): a script must not take that for a result.
int exit_code_with_output_checked(int exit_code);

/// While it lives: where a command's --out is "-", its file goes to standard output (burin/base/files/write_file.h),
/// and what it says to standard error.
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
