// burin/optimize/toolpath/toml_file.h - a file in TOML (toml.io, version 1.0), read with the strictness of
// burin/base/files/json_file.h.
//
// What a TOML file says is handed on as JSON, so that one reader serves both ways of writing it. JsonObject names file
// and field of what is wrong; with_line() adds the line, which a person edits by.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>

#include "burin/base/files/json_file.h"

namespace burin {

struct TomlFile {
  Json content;                     ///< tables as objects; keys in alphabetic order, as the parser hands them out
  std::map<std::string, int> line;  ///< of each value, from 1, by its dotted key: "limits.step_mm"
};

/// Reads a file and checks its "format" and "version" as read_json does. Throws Error with line and column for broken
/// TOML and for what has no counterpart in JSON (dates and times).
TomlFile read_toml(const std::filesystem::path& file, const std::string& format, int version);

/// Runs `read`; an Error that it throws about a field of the file gets the line in which the field stands:
/// "m.toml: limits.step_mm: is -1" becomes "m.toml:7: limits.step_mm: is -1".
void with_line(const std::filesystem::path& file, const TomlFile& toml, const std::function<void()>& read);

}  // namespace burin
