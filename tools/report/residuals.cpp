#include "tools/report/residuals.h"

#include <cmath>
#include <string>
#include <system_error>
#include <vector>

#include "burin/base/files/table.h"

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
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored)) return out;
  const std::vector<std::string> names{"view", "tag", "x_px", "y_px", "dx_px", "dy_px", "used"};
  TableReader table(file, TableStyle::vnlog, names, "run burin calibrate again");
  while (table.next()) {
    const auto at = [&](std::size_t name) { return *table.find(names[name]); };
    const auto value = [&](std::size_t name) { return table.number(at(name)); };
    ShownResidual r;
    r.view = table.text(at(0));
    r.tag = table.whole(at(1));
    r.q_px = {value(2), value(3)};
    r.residual_px = {value(4), value(5)};
    r.left_out = value(6) == 0;
    out.corners.push_back(r);
  }
  return out;
}

}  // namespace burin
