#include "burin/base/files/python_literal.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <system_error>

#include "burin/base/error.h"

namespace burin {

void PythonLiteral::error(const std::string& what) const {
  const auto line =
      1 + std::count(text_.begin(), text_.begin() + static_cast<std::ptrdiff_t>(std::min(at_, text_.size())), '\n');
  fail(where_ + ":" + std::to_string(line), what,
       "correct it there, or write the file again with the tool that made it");
}

void PythonLiteral::skip_blanks() {
  while (at_ < text_.size()) {
    if (text_[at_] == '#')
      at_ = std::min(text_.find('\n', at_), text_.size());
    else if (std::string_view(" \t\r\n").find(text_[at_]) != std::string_view::npos)
      ++at_;
    else
      return;
  }
}

bool PythonLiteral::take(char c) {
  skip_blanks();
  if (at_ >= text_.size() || text_[at_] != c) return false;
  ++at_;
  return true;
}

Json PythonLiteral::value() {
  Json result = parse(0);
  skip_blanks();
  if (at_ < text_.size()) error("has something after its end");
  return result;
}

Json PythonLiteral::parse(int depth) {
  constexpr int kDeepest = 50;  // far beyond any camera model; a file of brackets must not exhaust the stack
  if (depth > kDeepest) error("has brackets within brackets without end");
  skip_blanks();
  if (at_ >= text_.size()) error("ends too early");
  if (take('{')) {
    Json object = Json::object();
    while (!take('}')) {
      skip_blanks();
      const Json key = at_ < text_.size() && (text_[at_] == '\'' || text_[at_] == '"') ? parse_text() : Json();
      if (!key.is_string()) error("a name in quotes is missing");
      if (!take(':')) error("a colon is missing after '" + key.get<std::string>() + "'");
      object[key.get<std::string>()] = parse(depth + 1);
      if (!take(',') && (skip_blanks(), at_ >= text_.size() || text_[at_] != '}')) error("a comma or } is missing");
    }
    return object;
  }
  for (const char* brackets : {"[]", "()"}) {
    if (!take(brackets[0])) continue;
    Json array = Json::array();
    while (!take(brackets[1])) {
      array.push_back(parse(depth + 1));
      if (!take(',') && (skip_blanks(), at_ >= text_.size() || text_[at_] != brackets[1]))
        error(std::string("a comma or ") + brackets[1] + " is missing");
    }
    return array;
  }
  if (text_[at_] == '\'' || text_[at_] == '"') return parse_text();
  return parse_word();
}

Json PythonLiteral::parse_text() {
  const char quote = text_[at_];
  const std::size_t first = at_ + 1;
  for (std::size_t i = first; i < text_.size() && text_[i] != '\n'; ++i) {
    if (text_[i] == '\\') {
      ++i;
    } else if (text_[i] == quote) {
      at_ = i + 1;
      return std::string(text_.substr(first, i - first));
    }
  }
  error("text in quotes does not end");
}

Json PythonLiteral::parse_word() {
  std::size_t end = at_;
  while (end < text_.size() && (std::isalnum(static_cast<unsigned char>(text_[end])) ||
                                std::string_view("+-._").find(text_[end]) != std::string_view::npos))
    ++end;
  std::string_view word = text_.substr(at_, end - at_);
  if ((word == "b" || word == "r" || word == "u") && end < text_.size() && (text_[end] == '\'' || text_[end] == '"')) {
    at_ = end;
    return parse_text();
  }
  Json result;
  if (word == "True" || word == "False") {
    result = word == "True";
  } else if (word != "None") {
    std::string_view digits = word;
    if (digits.starts_with('+')) digits.remove_prefix(1);
    double number = 0;
    const auto parsed = std::from_chars(digits.data(), digits.data() + digits.size(), number);
    if (digits.empty() || parsed.ec != std::errc{} || parsed.ptr != digits.data() + digits.size() ||
        !std::isfinite(number))
      error("\"" + std::string(word.empty() ? text_.substr(at_, 1) : word.substr(0, 40)) + "\" is no finite number");
    result = number;
  }
  at_ = end;
  return result;
}

}  // namespace burin
