// burin/base/files/python_literal.h - reads a Python literal (dictionaries, lists, tuples, text, numbers, True,
// False, None, with comments and trailing commas), which is what a `.cameramodel` file is.
//
// libmrcal has a parser of its own, but version 2.2 reads beyond the end of files that are cut short and then crashes,
// prints to stderr, and cannot say which line is wrong. Include it in .cpp files only: it pulls in nlohmann-json.
#pragma once

#include <string>
#include <string_view>

#include "burin/base/files/json_file.h"

namespace burin {

/// Tuples become arrays, None becomes null, bytes become text. Escapes within text are kept as they are written.
class PythonLiteral {
 public:
  /// `where` is the file's name in messages. Both must outlive the call of value().
  PythonLiteral(std::string_view text, std::string where) : text_(text), where_(std::move(where)) {}

  /// The one value that the text holds. Throws Error naming the line of what is no Python literal.
  Json value();

 private:
  [[noreturn]] void error(const std::string& what) const;
  void skip_blanks();
  bool take(char c);
  Json parse(int depth);
  Json parse_text();
  Json parse_word();

  std::string_view text_;
  std::string where_;
  std::size_t at_ = 0;
};

}  // namespace burin
