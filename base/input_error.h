// burin/base/input_error.h - an Error as data: its code, place, problem and remedy, for programs that read --json.
#pragma once

#include <span>
#include <string>

#include "burin/base/error.h"

namespace burin {

/// Kind of a failure. docs/json.md lists the codes, and a test compares them.
enum class ErrorCode {
  bad_input,
  bad_json,
  bad_key,
  bad_table,
  command_line,
  fault,
  locked,
  missing_file,
  no_memory,
  no_threads,
  not_written,
  question,
  refused,
  stopped,
  unreadable_file
};

/// A code as programs read it, and its meaning.
struct ErrorCodeText {
  ErrorCode code;
  const char *name, *meaning;
};

/// All codes, in the order of the enumeration.
std::span<const ErrorCodeText> error_codes();

/// "bad-input"
const char* name_of(ErrorCode code);

/// The Error of every fail(): bad_input, unless fail_as() gave another code. Its parts are one line each.
struct InputError : Error {
  /// `where` and `remedy` may be empty.
  InputError(ErrorCode code, const std::string& where, const std::string& what, const std::string& remedy);
  ErrorCode code;
  std::string where, problem, remedy;  ///< as in fail()
};

/// Like fail(), with a code.
[[noreturn]] void fail_as(ErrorCode code, const std::string& where, const std::string& what, const std::string& remedy);

}  // namespace burin
