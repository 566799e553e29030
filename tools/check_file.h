// tools/check_file.h - `burin check FILE`: reads any file of ours with its own strict reader, and places the first
// error.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "tools/facts.h"

namespace burin {

/// A place in a text, from 1 on; columns count bytes.
struct TextPlace {
  std::size_t line = 1, column = 1;
};

/// The value that a field of a JSON text ("tags.list[3].size_mm") has, or the innermost object of the path that exists.
TextPlace place_of_field(std::string_view json, std::string_view field);

/// Reads the file as its "format" says, or as a table. Fails with file, line, column and field of the first error.
Report check_file(const std::filesystem::path& file);

}  // namespace burin
