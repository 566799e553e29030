// burin/optimize/depth_table.h - command of a pressing machine for a groove depth.
//
// A spring or drag bit is pressed by moving below the first contact (preload, mm of Z). A servo is pressed by its S
// value. The relation to depth belongs to one machine. A test piece gives its table, and photos of a board improve it:
// depths are sent times believed / measured (docs/model.md 7.4).
#pragma once

#include <string>
#include <vector>

namespace burin {

/// One measured pair.
struct DepthStep {
  double depth_um = 0;
  double command = 0;   ///< preload in mm of Z below contact, or a servo's S
  double sigma_um = 0;  ///< of the depth; 0: unknown
};

/// Rows with rising depths. Commands rise too; a servo's may fall. Interpolation between rows is linear.
struct DepthTable {
  std::vector<DepthStep> rows;
  bool assumed = false;  ///< nobody measured it: a built-in profile's table
};

/// The command for a depth. Throws Error, naming `where`, if the table does not contain the depth.
double command_for_depth(const DepthTable& table, double depth_um, const std::string& where);

/// The depth that a command makes, um. Commands softer than the first row interpolate to no depth at no preload if
/// `from_zero` (springs), else give NaN. Commands harder than the last row give NaN.
double depth_for_command(const DepthTable& table, double command, bool from_zero);

}  // namespace burin
