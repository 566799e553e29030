// burin/optimize/depth_table.h - what a machine must be told for a depth, where it presses instead of going there.
//
// A spring or a drag bit is pressed by going below the first contact (preload, mm of Z), a servo by its S value. What
// depth that makes only the machine itself knows: its table, measured on a test piece, or improved by photos of a board
// (depths are sent through believed / measured, docs/model.md 7.4).
#pragma once

#include <string>
#include <vector>

namespace burin {

/// One measured pair.
struct DepthStep {
  double depth_um = 0;
  double command = 0;   ///< preload in mm of Z below contact, or the servo's S
  double sigma_um = 0;  ///< of the depth; 0: not told
};

/// Depths rise from row to row, commands rise (or, for servos, fall). Between rows it is straight.
struct DepthTable {
  std::vector<DepthStep> rows;
  bool assumed = false;  ///< nobody measured it: a built-in profile's
};

/// What to tell the machine. Throws Error, naming `where`, for a depth beyond the table.
double command_for_depth(const DepthTable& table, double depth_um, const std::string& where);

/// What depth a command makes, um. Softer than the first row: straight down to no depth at no preload where `from_zero`
/// (springs), else NaN. Harder than the last row: NaN.
double depth_for_command(const DepthTable& table, double command, bool from_zero);

}  // namespace burin
