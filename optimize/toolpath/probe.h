// burin/optimize/toolpath/probe.h - the face probed by the machine that will carve it: the G-code that touches it on a
// grid (G38.2), and what the controller said of it as a height map.
//
// The file touches the face at the first point of the grid, sets Z zero there (G10 L20 P1), touches every point of the
// grid and at last the first one again. It goes so slowly that stopping takes less than half a micrometer.
// Frame: the machine's (burin/optimize/machine_profile.h), mm.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "burin/base/finding.h"
#include "burin/optimize/machine_profile.h"
#include "burin/optimize/toolpath/height_map.h"
#include "burin/optimize/toolpath/workpiece.h"
#include "burin/scene/board.h"

namespace burin {

/// Points of the carve area that are clear of tags and keep-outs, on a regular grid; in the order to be probed, from
/// side to side. The last one is the first again.
struct ProbePlan {
  std::vector<Eigen::Vector2d> points_mm;
  Workpiece workpiece;  ///< that is probed
};

/// A grid over the carve area with about this distance between its points. Throws Error where fewer than four points
/// are free.
ProbePlan probe_plan(const Board& board, double spacing_mm);

/// The fastest that the face is touched, mm/min.
inline constexpr double kTouchFeed_mm_min = 60;

/// The file for the machine. Throws Error for machines that cannot say heights finely enough (Marlin), and for those
/// whose depth does not come from Z (servos).
std::string probe_gcode(const ProbePlan& plan, const MachineProfile& machine);

/// A height map, and what a person should know of it.
struct ProbedHeights {
  HeightMap map;
  std::vector<Finding> findings;
};

/// Reads what the controller logged while it ran `probe_file` (whose text is `gcode`): grbl's serial log, of which the
/// [PRB:x,y,z:1] lines count (its machine coordinates, mm), or the file that LinuxCNC's PROBEOPEN wrote (work
/// coordinates). What stands in the log before the last complete run is passed over. Throws Error, saying where, for a
/// log that is no such thing, holds too few points or failed ones, was taken at other places or in inches, for a tilt
/// or an outlier that no sheet has, and for a zero that moved.
ProbedHeights read_probe_log(std::string_view log, const std::filesystem::path& log_file, std::string_view gcode,
                             const std::filesystem::path& probe_file);

}  // namespace burin
