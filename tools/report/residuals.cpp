#include "tools/report/residuals.h"

#include <fmt/core.h>

#include <cmath>
#include <fstream>
#include <map>
#include <sstream>

#include "burin/render/error.h"

namespace burin {

double ResidualTable::rms_px() const {
  double squares = 0;
  std::size_t count = 0;
  for (const ShownResidual& r : corners) {
    if (r.left_out) continue;
    squares += r.residual_px.squaredNorm();
    ++count;
  }
  return count == 0 ? 0 : std::sqrt(squares / (2.0 * static_cast<double>(count)));
}

ResidualTable read_residuals(const std::filesystem::path& file) {
  ResidualTable out;
  std::ifstream in(file);
  if (!in) return out;
  const auto broken = [&](int line, const std::string& what) {
    fail(fmt::format("{}:{}", file.string(), line), what, "run burin calibrate again");
  };
  std::map<std::string, std::size_t> column;
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    if (line.empty() || line.starts_with("##") || line.starts_with("#!")) continue;
    std::istringstream words(line.starts_with('#') ? line.substr(1) : line);
    std::vector<std::string> fields;
    for (std::string word; words >> word;) fields.push_back(word);
    if (line.starts_with('#')) {
      if (column.empty())
        for (std::size_t i = 0; i < fields.size(); ++i) column[fields[i]] = i;
      continue;
    }
    const auto field = [&](const char* name) -> const std::string& {
      const auto it = column.find(name);
      if (it == column.end() || it->second >= fields.size())
        broken(number, fmt::format("there is no column '{}'", name));
      return fields[it->second];
    };
    const auto value = [&](const char* name) {
      const std::string& text = field(name);
      try {
        return std::stod(text);
      } catch (const std::exception&) {
        broken(number, fmt::format("{} is '{}', not a number", name, text));
      }
      return 0.0;
    };
    ShownResidual r;
    r.view = field("view");
    r.tag = static_cast<int>(value("tag"));
    r.q_px = {value("x_px"), value("y_px")};
    r.residual_px = {value("dx_px"), value("dy_px")};
    r.left_out = value("used") == 0;
    out.corners.push_back(r);
  }
  return out;
}

}  // namespace burin
