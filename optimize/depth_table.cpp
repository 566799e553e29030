#include "burin/optimize/depth_table.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "burin/base/error.h"
#include "burin/base/files/decimals.h"

namespace burin {

double command_for_depth(const DepthTable& table, double depth_um, const std::string& where) {
  const std::vector<DepthStep>& rows = table.rows;
  if (rows.size() < 2) fail(where, "has no table from depth to command", "add depth_table to the machine profile");
  constexpr double kRounding_um = 1e-6;
  if (!(depth_um >= rows.front().depth_um - kRounding_um && depth_um <= rows.back().depth_um + kRounding_um))
    fail(where,
         "has no command for a depth of " + significant(depth_um, 4) + " um: its depth_table goes from " +
             significant(rows.front().depth_um, 4) + " to " + significant(rows.back().depth_um, 4) + " um",
         "carve a coupon with depths like that (burin coupon write --depths), or design for another depth");
  const auto above =
      std::find_if(rows.begin() + 1, rows.end() - 1, [&](const DepthStep& row) { return row.depth_um >= depth_um; });
  const DepthStep &a = *(above - 1), &b = *above;
  return a.command + (b.command - a.command) * (depth_um - a.depth_um) / (b.depth_um - a.depth_um);
}

double depth_for_command(const DepthTable& table, double command, bool from_zero) {
  if (table.rows.size() < 2) return std::numeric_limits<double>::quiet_NaN();
  std::vector<DepthStep> rows = table.rows;
  if (from_zero) rows.insert(rows.begin(), {0, 0});
  // The decimals of a file can put a command this far outside the table.
  const double rounding = 1e-4 * std::abs(rows.back().command - rows.front().command);
  for (std::size_t i = 0; i + 1 < rows.size(); ++i) {
    const DepthStep &a = rows[i], &b = rows[i + 1];
    const double low = std::min(a.command, b.command) - rounding, high = std::max(a.command, b.command) + rounding;
    if (command >= low && command <= high)
      return a.depth_um + (b.depth_um - a.depth_um) * (command - a.command) / (b.command - a.command);
  }
  return std::numeric_limits<double>::quiet_NaN();
}

}  // namespace burin
