// burin/optimize/toolpath/toml_file.h - a strict reader for TOML (toml.io, version 1.0), like
// burin/base/files/json_file.h.
//
// The reader returns a TOML file as JSON, so one reader of fields serves both. JsonObject names file and field of an
// error; with_line() adds the line for a person's editor.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>

#include "burin/base/files/json_file.h"

namespace burin {

struct TomlFile {
  Json content;                     ///< tables as objects; keys in alphabetic order, as the parser returns them
  std::map<std::string, int> line;  ///< of each value, from 1, by its dotted key: "limits.step_mm"
};

/// Reads a file and checks its "format" and "version" as read_json does. Throws Error with line and column for broken
/// TOML, and for types without a counterpart in JSON (dates and times).
TomlFile read_toml(const std::filesystem::path& file, const std::string& format, int version);

/// Runs `read`, and adds a field's line to an Error about it: "m.toml: limits.step_mm: is -1" becomes "m.toml:7:
/// limits.step_mm: is -1".
void with_line(const std::filesystem::path& file, const TomlFile& toml, const std::function<void()>& read);

}  // namespace burin
