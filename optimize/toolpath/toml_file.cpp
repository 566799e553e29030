#include "burin/optimize/toolpath/toml_file.h"

#include "burin/base/error.h"

namespace burin {
namespace {

[[noreturn]] void fail_broken_off() { throw Error("a bracket or a key is broken off"); }

}  // namespace
}  // namespace burin

// Failed assumptions of the parser ("[" at the end of a line) become an error in every build. With assert() they would
// end the program in some builds, and pass in others.
#pragma push_macro("NDEBUG")
#undef NDEBUG
#define TOML_ASSERT(expression) ((expression) ? void() : burin::fail_broken_off())
// Debian builds toml++ as a separate library, which users of an installed Burin would also need.
#undef TOML_HEADER_ONLY
#undef TOML_SHARED_LIB
#define TOML_HEADER_ONLY 1
#include <toml++/toml.h>
#pragma pop_macro("NDEBUG")

#include <algorithm>
#include <string_view>
#include <utility>

#include "burin/base/files/input_file.h"
#include "burin/base/files/printable.h"
#include "burin/base/limits.h"

namespace burin {
namespace {

// toml++ 3 misreads letters beyond ASCII outside of text, and sometimes inside. So the parser gets ASCII alone: each
// byte of such a letter becomes @ and two hexadecimal digits, and @ itself becomes @@. Outside of quotes and comments
// TOML has no @, and the parser rejects it. as_json() restores the letters in them.
std::string in_ascii(std::string_view text) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string out;
  out.reserve(text.size());
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x80) {
      out += c;
      if (c == '@') out += '@';
    } else {
      out += {'@', kDigits[byte >> 4], kDigits[byte & 15]};
    }
  }
  return out;
}

// Restores the input of in_ascii(). An @ that the file spelled otherwise (\u0040) stays.
std::string as_written(std::string_view text) {
  const auto digit = [](char c) { return c >= '0' && c <= '9' ? c - '0' : c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1; };
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    out += text[i];
    if (text[i] != '@') continue;
    if (text.substr(i + 1).starts_with('@')) {
      ++i;
    } else if (i + 2 < text.size() && digit(text[i + 1]) >= 8 && digit(text[i + 2]) >= 0) {
      out.back() = static_cast<char>(16 * digit(text[i + 1]) + digit(text[i + 2]));
      i += 2;
    }
  }
  return out;
}

// The output of in_ascii() for a file, with a map of positions for error messages.
struct AsciiToml {
  const std::filesystem::path& file;
  std::string text;
};

// From a place in the text to the end of its line.
std::string_view line_from(std::string_view text, const toml::source_position& at) {
  for (toml::source_index line = 1; line < at.line; ++line)
    text.remove_prefix(std::min(text.find('\n'), text.size() - 1) + 1);
  return text.substr(0, text.find('\n'));
}

// FILE:LINE:COLUMN in the original file; columns count letters.
std::string at_line(const AsciiToml& toml, const toml::source_position& at) {
  const std::string before = as_written(line_from(toml.text, at).substr(0, at.column - 1));
  const auto letters = std::count_if(before.begin(), before.end(), [](char c) { return (c & 0xC0) != 0x80; });
  return toml.file.string() + ":" + std::to_string(at.line) + ":" + std::to_string(letters + 1);
}

// True if the position holds a letter beyond ASCII.
bool is_foreign_letter(const AsciiToml& toml, const toml::source_position& at) {
  const std::string_view line = line_from(toml.text, at);
  const std::string_view rest = line.substr(std::min<std::size_t>(at.column - 1, line.size()));
  return rest.starts_with('@') && !rest.starts_with("@@");
}

Json as_json(const toml::node& node, const std::string& key, const AsciiToml& toml, std::map<std::string, int>& line) {
  if (!key.empty()) line[key] = static_cast<int>(node.source().begin.line);
  switch (node.type()) {
    case toml::node_type::table: {
      Json object = Json::object();
      for (const auto& [name, value] : *node.as_table()) {
        const std::string own = as_written(name.str());
        std::string place = key;
        if (!place.empty()) place += '.';
        place += own;
        object[own] = as_json(value, place, toml, line);
      }
      return object;
    }
    case toml::node_type::array: {
      Json array = Json::array();
      for (const toml::node& value : *node.as_array())
        array.push_back(as_json(value, key + "[" + std::to_string(array.size()) + "]", toml, line));
      return array;
    }
    case toml::node_type::string: {
      const std::string text = as_written(node.as_string()->get());
      if (!is_printable(text))
        fail(at_line(toml, node.source().begin) + ": " + key, "holds a control character",
             "write text that can be read, on one line: no escapes, no zero bytes");
      return text;
    }
    case toml::node_type::integer:
      return node.as_integer()->get();
    case toml::node_type::floating_point:
      return node.as_floating_point()->get();
    case toml::node_type::boolean:
      return node.as_boolean()->get();
    default:
      fail(at_line(toml, node.source().begin) + ": " + key, "is a date or a time",
           "write a number, or text in double quotes");
  }
}

std::string line_of(const std::filesystem::path& file, std::string_view text, std::size_t at) {
  return file.string() + ":" +
         std::to_string(1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n'));
}

}  // namespace

void with_line(const std::filesystem::path& file, const TomlFile& toml, const std::function<void()>& read) {
  try {
    read();
  } catch (const Error& error) {
    const std::string message = error.what(), before = file.string() + ": ";
    if (!message.starts_with(before)) throw;
    const std::string field = message.substr(before.size(), message.find(": ", before.size()) - before.size());
    const auto found = toml.line.find(field);
    if (found == toml.line.end()) throw;
    throw Error(file.string() + ":" + std::to_string(found->second) + ": " + message.substr(before.size()));
  }
}

TomlFile read_toml(const std::filesystem::path& file, const std::string& format, int version) {
  const std::string text = read_bytes(file, limit::kTomlBytes, "a TOML file");
  if (const std::size_t zero = text.find('\0'); zero != std::string::npos)
    fail(line_of(file, text, zero), "holds a zero byte, so it is no TOML", "check that it is the right file");
  const std::string_view content = std::string_view(text).substr(text.starts_with("\xEF\xBB\xBF") ? 3 : 0);
  const AsciiToml ascii{file, in_ascii(content)};
  TomlFile toml;
  try {
    const toml::table table = toml::parse(ascii.text);
    toml.content = as_json(table, "", ascii, toml.line);
  } catch (const Error& error) {
    if (std::string_view(error.what()).starts_with(file.string())) throw;
    fail(file.string(), std::string("is not TOML: ") + error.what(),
         "correct its brackets [ ] and what stands in them");
  } catch (const toml::parse_error& error) {
    if (is_foreign_letter(ascii, error.source().begin))
      fail(at_line(ascii, error.source().begin), "is not TOML: a letter that is not ASCII stands outside of quotes",
           "put text in double quotes, or begin a comment with #");
    fail(at_line(ascii, error.source().begin), "is not TOML: " + printable(as_written(error.description())),
         "correct it there (a key, =, and a number, text in double quotes, or an array in [ ])");
  }
  with_line(file, toml, [&] { check_format(JsonObject(toml.content, file.string()), format, version); });
  return toml;
}

}  // namespace burin
