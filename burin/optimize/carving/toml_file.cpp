#include "burin/optimize/carving/toml_file.h"

// Debian builds toml++ as a library of its own, which those who link an installed Burin would have to find too.
#undef TOML_HEADER_ONLY
#undef TOML_SHARED_LIB
#define TOML_HEADER_ONLY 1
#include <toml++/toml.h>

#include <algorithm>
#include <utility>

#include "burin/render/error.h"
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
  if (const std::size_t zero = text.find('\0'); zero != std::string::npos)  // toml++ asserts on some of them
    fail(file.string() + ":" +
             std::to_string(1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(zero), '\n')),
         "holds a zero byte, so it is no TOML", "check that it is the right file");
  TomlFile toml;
  try {
    const toml::table table = toml::parse(text);
    toml.content = as_json(table, "", file, toml.line);
  } catch (const toml::parse_error& error) {
    fail(at_line(file, error.source()), "is not TOML: " + std::string(error.description()),
         "correct it there (a key, =, and a number, text in double quotes, or an array in [ ])");
  }
  with_line(file, toml, [&] { check_format(JsonObject(toml.content, file.string()), format, version); });
  return toml;
}

}  // namespace burin
