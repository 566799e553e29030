// tools/loop/toml_line.h - changes one value of a TOML file and preserves the user's other lines and comments.
#pragma once

#include <string>

namespace burin {

/// Returns `text` with `key = value` in [table] ("" for the keys before all tables). Replaces the line of the key, or
/// adds one. `value` is TOML. Supports one key per line and tables with a [header]. For other TOML syntax, the caller
/// must read the result again and compare.
std::string with_toml_value(const std::string& text, const std::string& table, const std::string& key,
                            const std::string& value);

}  // namespace burin
