// burin/base/files/python_literal.h - parser of Python literals (dictionaries, lists, tuples, text, numbers, True,
// False, None, with comments and trailing commas), the format of `.cameramodel` files.
//
// libmrcal has its own parser, but version 2.2 reads beyond the end of truncated files and crashes, prints to stderr,
// and cannot report the faulty line. Include it in .cpp files only: it pulls in nlohmann-json.
#pragma once

#include <string>
#include <string_view>

#include "burin/base/files/json_file.h"

namespace burin {

/// Tuples become arrays, None becomes null, bytes become text. Escapes within text remain as written.
class PythonLiteral {
 public:
  /// `where` is the file's name in messages. Both must outlive the call of value().
  PythonLiteral(std::string_view text, std::string where) : text_(text), where_(std::move(where)) {}

  /// The only value in the text. Throws Error with the line of a syntax error.
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
