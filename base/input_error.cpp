#include "burin/base/input_error.h"

#include "burin/base/files/printable.h"

namespace burin {
namespace {

// Libraries report errors in several lines; people get one sentence.
std::string one_line(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c != '\n' && c != '\r')
      out += c;
    else if (!out.empty() && !out.ends_with(", "))
      out += ", ";
  }
  while (out.ends_with(", ")) out.resize(out.size() - 2);
  return printable(out);
}

constexpr ErrorCodeText kErrorCodes[] = {
    {ErrorCode::bad_input, "bad-input", "A file, a value or a combination of options cannot be used."},
    {ErrorCode::bad_json, "bad-json", "A file is not JSON."},
    {ErrorCode::bad_key, "bad-key",
     "A key of a JSON or TOML file is unknown, missing or repeated, or its value is wrong."},
    {ErrorCode::bad_table, "bad-table", "A table (CSV, VNL) has a wrong column, row or number."},
    {ErrorCode::command_line, "command-line", "The command line is wrong. The exit code is 2."},
    {ErrorCode::fault, "fault", "The cause is a fault in Burin. Please report it."},
    {ErrorCode::locked, "locked", "Another burin works in this folder."},
    {ErrorCode::missing_file, "missing-file", "An input file or folder does not exist."},
    {ErrorCode::no_memory, "no-memory", "Memory ran out."},
    {ErrorCode::no_threads, "no-threads", "The system allows too few threads."},
    {ErrorCode::not_written, "not-written", "An output cannot be written: rights, a full disk, a link."},
    {ErrorCode::question, "question", "The project needs an answer from you: an option of `burin loop`."},
    {ErrorCode::refused, "refused", "The work is done, and its result must not be used as it is."},
    {ErrorCode::stopped, "stopped", "A signal stopped the command. The exit code is 128 plus its number."},
    {ErrorCode::unreadable_file, "unreadable-file", "An input file exists and cannot be read."},
};

}  // namespace

std::span<const ErrorCodeText> error_codes() { return kErrorCodes; }

const char* name_of(ErrorCode code) { return kErrorCodes[static_cast<std::size_t>(code)].name; }

InputError::InputError(ErrorCode of, const std::string& at, const std::string& what_is_wrong,
                       const std::string& its_remedy)
    : Error(one_line((at.empty() ? "" : at + ": ") + what_is_wrong + (its_remedy.empty() ? "" : "; " + its_remedy))),
      code(of),
      where(one_line(at)),
      problem(one_line(what_is_wrong)),
      remedy(one_line(its_remedy)) {}

void fail(const std::string& where, const std::string& what, const std::string& remedy) {
  fail_as(ErrorCode::bad_input, where, what, remedy);
}

void fail_as(ErrorCode code, const std::string& where, const std::string& what, const std::string& remedy) {
  throw InputError(code, where, what, remedy);
}

}  // namespace burin
