// tools/loop/toml_line.h - one value of a TOML file changed, the person's own lines and comments left as they are.
#pragma once

#include <string>

namespace burin {

/// `text` with `key = value` in [table] ("" for the keys before all tables): the line that has the key is replaced, or
/// one is added. `value` is TOML. Knows one key a line and tables with a [header]; of other ways to write TOML the
/// outcome must be read again and compared.
std::string with_toml_value(const std::string& text, const std::string& table, const std::string& key,
                            const std::string& value);

}  // namespace burin
