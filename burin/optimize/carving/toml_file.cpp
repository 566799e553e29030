#include "burin/optimize/carving/toml_file.h"

#include "burin/render/error.h"

namespace burin {
namespace {

[[noreturn]] void fail_broken_off() { throw Error("a bracket or a key is broken off"); }

}  // namespace
}  // namespace burin

// What the parser takes for granted and then finds otherwise ("[" at the end of a line): an error, in every build,
// instead of assert()'s end of the program in some and of nothing in others.
#pragma push_macro("NDEBUG")
#undef NDEBUG
#define TOML_ASSERT(expression) ((expression) ? void() : burin::fail_broken_off())
// Debian builds toml++ as a library of its own, which those who link an installed Burin would have to find too.
#undef TOML_HEADER_ONLY
#undef TOML_SHARED_LIB
#define TOML_HEADER_ONLY 1
#include <toml++/toml.h>
#pragma pop_macro("NDEBUG")

#include <algorithm>
#include <string_view>
#include <utility>

#include "burin/render/files/input_file.h"
#include "burin/render/files/printable.h"
#include "burin/render/limits.h"

namespace burin {
namespace {

std::string at_line(const std::filesystem::path& file, const toml::source_region& source) {
  return file.string() + ":" + std::to_string(source.begin.line) + ":" + std::to_string(source.begin.column);
}

Json as_json(const toml::node& node, const std::string& key, const std::filesystem::path& file,
             std::map<std::string, int>& line) {
  if (!key.empty()) line[key] = static_cast<int>(node.source().begin.line);
  switch (node.type()) {
    case toml::node_type::table: {
      Json object = Json::object();
      for (const auto& [name, value] : *node.as_table()) {
        std::string place = key;
        if (!place.empty()) place += '.';
        place += name.str();
        object[std::string(name.str())] = as_json(value, place, file, line);
      }
      return object;
    }
    case toml::node_type::array: {
      Json array = Json::array();
      for (const toml::node& value : *node.as_array())
        array.push_back(as_json(value, key + "[" + std::to_string(array.size()) + "]", file, line));
      return array;
    }
    case toml::node_type::string:
      if (!is_printable(node.as_string()->get()))
        fail(at_line(file, node.source()) + ": " + key, "holds a control character",
             "write text that can be read, on one line: no escapes, no zero bytes");
      return node.as_string()->get();
    case toml::node_type::integer:
      return node.as_integer()->get();
    case toml::node_type::floating_point:
      return node.as_floating_point()->get();
    case toml::node_type::boolean:
      return node.as_boolean()->get();
    default:
      fail(at_line(file, node.source()) + ": " + key, "is a date or a time",
           "write a number, or text in double quotes");
  }
}

/// Where text that is not ASCII stands outside of quotes and comments, where TOML has none: toml++ 3 goes astray on
/// some of it. std::string::npos if nowhere.
std::size_t bare_foreign_letter(std::string_view text) {
  constexpr std::string_view kBeforeText = " \t\r\n=[,{.";  // a quote elsewhere begins no text
  std::string_view quotes;                                  // that end what was begun; empty outside
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (!quotes.empty()) {
      if (text[i] == '\\' && quotes[0] == '"')
        ++i;
      else if (text.substr(i).starts_with(quotes) || (quotes.size() == 1 && text[i] == '\n'))
        i += quotes.size() - 1, quotes = {};
    } else if (text[i] == '#') {
      i = std::min(text.find('\n', i), text.size());
    } else if ((text[i] == '"' || text[i] == '\'') &&
               (i == 0 || kBeforeText.find(text[i - 1]) != std::string_view::npos)) {
      const std::string_view three = text.substr(i, 3);
      quotes = three == "\"\"\"" || three == "'''" ? three : text.substr(i, 1);
      i += quotes.size() - 1;
    } else if (static_cast<unsigned char>(text[i]) >= 0x80) {
      return i;
    }
  }
  return std::string_view::npos;
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
  if (const std::size_t letter = bare_foreign_letter(content); letter != std::string_view::npos)
    fail(line_of(file, content, letter), "is not TOML: a letter that is not ASCII stands outside of quotes",
         "put text in double quotes, or begin a comment with #");
  TomlFile toml;
  try {
    const toml::table table = toml::parse(content);
    toml.content = as_json(table, "", file, toml.line);
  } catch (const Error& error) {
    if (std::string_view(error.what()).starts_with(file.string())) throw;
    fail(file.string(), std::string("is not TOML: ") + error.what(),
         "correct its brackets [ ] and what stands in them");
  } catch (const toml::parse_error& error) {
    fail(at_line(file, error.source()), "is not TOML: " + std::string(error.description()),
         "correct it there (a key, =, and a number, text in double quotes, or an array in [ ])");
  }
  with_line(file, toml, [&] { check_format(JsonObject(toml.content, file.string()), format, version); });
  return toml;
}

}  // namespace burin
