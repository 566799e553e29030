// burin/optimize/toolpath.h - scratches into a file that a machine carves: G-code, SVG, DXF.
//
// Machine coordinates are the board's (burin/optimize/machine_profile.h). With a measured bench, what is sent to the
// machine is the designed scratch through the inverse of `machine.affine`, so that the carved scratch lies where it was
// designed (docs/model.md 7.2). Depths sent to the machine are those it was told before: the board's believed depth.
// What the photos measured (`material.depth_um`) is what the machine made of that, so scratches with depths of their
// own are scaled by believed / measured; sending the measured depth as the new command would deepen the grooves from
// round to round.
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

/// Whether a file's name ends as G-code's do: .gcode, .nc, .ngc (LinuxCNC), .cnc (Snapmaker), .tap (Mach).
bool has_gcode_name(const std::filesystem::path& file);

struct ToolpathReport {
  std::vector<std::filesystem::path> files;  ///< in the order to be carved; the frame, if asked for, comes last
  std::vector<double> file_duration_s;
  std::size_t scratch_count = 0;
  double duration_s = 0, carve_mm = 0, travel_mm = 0;
  double file_order_travel_mm = 0;  ///< what the travel would have been in the order of the scratches given
  Eigen::Vector2d min_mm, max_mm;
  std::vector<CarvingStep> order;
  Sent sent;                              ///< what the machine is told, in carving order: what sent.csv holds
  std::vector<ReplayedScratch> replayed;  ///< of G-code: what the files carve, read back from the disk
  bool kept_order = false;                ///< whether the order is that of the scratches given
  bool compensated = false;
  std::size_t already_carved = 0;
  double stepped_mm = 0;
  std::size_t done_before = 0;
  Face face;                      ///< that Z follows, if it follows one, and where Z is then to be set to zero
  std::vector<Finding> findings;  ///< what a person should know of depths on this sheet, or of a drawing's
  std::vector<std::filesystem::path>
      removed;  ///< an earlier tool path's files of the same name, which nobody may carve
};

/// Plans and writes `out` by its extension: .gcode, .nc, .ngc, .svg, .dxf or .csv (the
/// scratches as sent, in carving order, with their width, depth and alpha). What no drawing holds (a frame, parts, a
/// face to follow) is then an Error. G-code of several parts becomes
/// out-01.gcode, out-02.gcode, ...; what an earlier run left of that name is removed: the whole where there are parts
/// now, and files whose head names them as that part of several. G-code is read
/// back from the disk and replayed before it gets its name: a scratch lost, doubled, mirrored or too deep is an Error
/// and nothing is written; so is G-code that goes to a fixed Z on a sheet that is known to be less even than that depth
/// (carving/sheet.h). After an interruption no other file is removed, and `out` may not be the interrupted one.
ToolpathReport write_toolpath(const Scratches& scratches, const Board& board, const Bench* measured,
                              const MachineProfile& machine, const ToolpathOptions& options,
                              const std::filesystem::path& out, const Progress& progress = {});

}  // namespace burin
