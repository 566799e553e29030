// burin/optimize/toolpath.h - scratches as a file for a carving machine: G-code, SVG, DXF.
//
// Machine coordinates are the board's (burin/optimize/machine_profile.h). With a measured bench, the commanded
// trajectory is the designed scratch through the inverse of `machine.affine`. The carved scratch is then at its
// designed place (docs/model.md 7.2). Commanded depths are relative to the board's believed depth. The measured depth
// (`material.depth_um`) is the machine's answer to this command, so scratches with depths of their own are scaled by
// believed / measured. Sending the measured depth as the new command would deepen the grooves from round to round.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <filesystem>
#include <vector>

#include "burin/base/finding.h"
#include "burin/optimize/toolpath/drawing.h"
#include "burin/optimize/toolpath/gcode.h"
#include "burin/optimize/toolpath/toolpath_plan.h"

namespace burin {

/// Whether a file has a name of G-code: .gcode, .nc, .ngc (LinuxCNC), .cnc (Snapmaker), .tap (Mach).
bool has_gcode_name(const std::filesystem::path& file);

/// Written files, their duration and diagnostics.
struct ToolpathReport {
  std::vector<std::filesystem::path> files;  ///< in carving order; the frame, if requested, is last
  std::vector<double> file_duration_s;
  std::size_t scratch_count = 0;
  double duration_s = 0, carve_mm = 0, travel_mm = 0;
  double file_order_travel_mm = 0;  ///< travel in the order of the given scratches, for comparison
  Eigen::Vector2d min_mm, max_mm;
  std::vector<CarvingStep> order;
  Sent sent;                              ///< the commanded trajectory in carving order: the content of sent.csv
  std::vector<ReplayedScratch> replayed;  ///< of G-code: the scratches in the files, read back from the disk
  bool kept_order = false;                ///< whether the order is the given scratches' own
  bool compensated = false;
  std::size_t already_carved = 0;
  double stepped_mm = 0;
  std::size_t done_before = 0;
  Face face;                      ///< the face that Z follows, if any, and the place of Z's zero setting
  std::vector<Finding> findings;  ///< on depths on this sheet, or on a drawing's depths
  std::vector<std::filesystem::path>
      removed;  ///< files of an earlier tool path with the same name, which nobody may carve
};

/// Plans a tool path and writes `out` by its extension: .gcode, .nc, .ngc, .cnc, .tap, .svg, .dxf or .csv. A .csv holds
/// the scratches as sent, in carving order, with their width, depth and alpha. A drawing or table cannot hold a frame,
/// parts or a face to follow: these options then throw Error.
///
/// G-code of several parts becomes out-01.gcode, out-02.gcode, ... Leftovers of an earlier run with that name are
/// removed. These are the undivided file if there are parts, and files whose head names them as this part of several.
/// After an interruption no other file is removed, and `out` may not be the interrupted one.
///
/// G-code is read back from the disk and replayed before it gets its name. Throws Error, and writes nothing, if a
/// scratch is lost, doubled, mirrored or too deep. Also throws Error for G-code with a fixed Z if the known unevenness
/// of the sheet exceeds the depth (toolpath/sheet.h).
ToolpathReport write_toolpath(const Scratches& scratches, const Board& board, const Bench* measured,
                              const MachineProfile& machine, const ToolpathOptions& options,
                              const std::filesystem::path& out, const Progress& progress = {});

}  // namespace burin
