// burin/optimize/toolpath/probe.h - probing of the face by the carving machine: G-code with touches on a grid (G38.2),
// and the controller's log as a height map.
//
// The file touches the face at the first point of the grid, sets Z zero there (G10 L20 P1), touches every point of the
// grid, and finally the first one again. At its feed, stopping takes less than half a micrometer. Frame: the machine's
// (burin/optimize/machine_profile.h), mm.
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

/// Points of the carve area clear of tags and keep-outs, on a regular grid, in probing order from side to side. The
/// last one repeats the first.
struct ProbePlan {
  std::vector<Eigen::Vector2d> points_mm;
  Workpiece workpiece;  ///< sheet to be probed
};

/// A grid over the carve area with about this distance between its points. Throws Error with fewer than four free
/// points.
ProbePlan probe_plan(const Board& board, double spacing_mm);

/// Largest feed of a touch, mm/min.
inline constexpr double kTouchFeed_mm_min = 60;

/// The file for the machine. Throws Error for machines without a fine enough log of heights (Marlin), and for servos,
/// whose depth does not come from Z.
std::string probe_gcode(const ProbePlan& plan, const MachineProfile& machine);

/// A height map, and its findings for a person.
struct ProbedHeights {
  HeightMap map;
  std::vector<Finding> findings;
};

/// Reads the controller's log of `probe_file` (whose text is `gcode`). In grbl's serial log the [PRB:x,y,z:1] lines
/// count (machine coordinates, mm); the other kind is the file of LinuxCNC's PROBEOPEN (work coordinates). Lines before
/// the last complete run are skipped. Throws Error with the line for a log of another kind, with too few points or
/// failed ones, at other places or in inches. Also throws for an implausible tilt or outlier, and for a moved zero.
ProbedHeights read_probe_log(std::string_view log, const std::filesystem::path& log_file, std::string_view gcode,
                             const std::filesystem::path& probe_file);

}  // namespace burin
