// tools/old_names.h - names of options of the version before, which this version still accepts.
#pragma once

#include <string>
#include <vector>

namespace burin {

/// An option that has another name now.
struct OldName {
  const char* command;  ///< "design"; `loop` takes the options of design, toolpath and capture, too
  const char *old_name, *new_name;
  const char* value = "";  ///< of the new name, if the old one was a flag: --free-width is --free width
  const char* unit = "";   ///< of a bare number under the old name: --carve-hours 6 is --carve-time 6h
};

/// Replaces old names among the arguments of a command line, from the index `behind` its command on. Prints a note for
/// each.
void replace_old_names(const std::string& command, std::size_t behind, std::vector<std::string>& arguments);

/// The present form of an option of a command in loop.toml: its name without dashes, and values.
struct NamedValues {
  std::string name;
  std::vector<std::string> values;
};
NamedValues with_new_name(const std::string& command, const std::string& name, std::vector<std::string> values);

}  // namespace burin
