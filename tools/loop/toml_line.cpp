#include "tools/loop/toml_line.h"

#include <sstream>
#include <vector>

namespace burin {
namespace {

std::string trimmed(const std::string& text) {
  const std::size_t begin = text.find_first_not_of(" \t\r");
  if (begin == std::string::npos) return "";
  return text.substr(begin, text.find_last_not_of(" \t\r") - begin + 1);
}

}  // namespace

std::string with_toml_value(const std::string& text, const std::string& table, const std::string& key,
                            const std::string& value) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);

  const std::string wanted = key + " = " + value;
  std::string in;
  bool table_seen = table.empty();
  std::size_t last = 0;  // behind the last non-empty line of the table
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const std::string line = trimmed(lines[i]);
    if (line.starts_with('[')) in = trimmed(line.substr(1, line.find(']') - 1));
    if (in != table) continue;
    table_seen = true;
    if (!line.empty()) last = i + 1;
    if (line.starts_with('[') || line.find('=') == std::string::npos) continue;
    if (trimmed(line.substr(0, line.find('='))) != key) continue;
    lines[i] = wanted;
    last = lines.size() + 1;  // replaced
    break;
  }
  if (last <= lines.size()) {
    if (!table_seen) {
      if (!lines.empty() && !trimmed(lines.back()).empty()) lines.emplace_back();
      lines.push_back("[" + table + "]");
      last = lines.size();
    }
    lines.insert(lines.begin() + static_cast<std::ptrdiff_t>(last), wanted);
  }
  std::string out;
  for (const std::string& line : lines) out += line + "\n";
  return out;
}

}  // namespace burin
