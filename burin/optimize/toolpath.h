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
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "burin/optimize/carving/carving_limits.h"
#include "burin/optimize/carving/carving_order.h"
#include "burin/optimize/machine_profile.h"
#include "burin/render/bench.h"
#include "burin/render/board.h"
#include "burin/render/progress.h"
#include "burin/render/scratches.h"

namespace burin {

/// One scratch as it is sent to the machine.
struct PlannedScratch {
  std::uint32_t scratch = 0;       ///< its row in the scratches, from 0
  Eigen::Vector2d from_mm, to_mm;  ///< machine coordinates, compensated
  double depth_mm = 0;             ///< below the face, positive
};

struct Toolpath {
  std::vector<PlannedScratch> scratches;  ///< in carving order
  std::vector<CarvingStep> order;         ///< the same order, by row of the scratches that were given
  Eigen::Vector2d min_mm, max_mm;         ///< what the tool's tip covers while carving
  double carve_mm = 0, travel_mm = 0;     ///< ways in the metal and in the air (from work zero)
  double file_order_travel_mm = 0;        ///< what the travel would be in the order of the scratches given
  double duration_s = 0;                  ///< estimate, with acceleration, for the built-in way to carve a scratch
  bool compensated = false;               ///< whether a measured affine map other than none was undone
  std::size_t already_carved = 0;         ///< rows of the scratches given that are in the metal and are left out
  double stepped_mm = 0;                  ///< the farthest that the machine's steps move an end
  std::size_t done_before = 0;            ///< scratches of the interrupted file that are done
};

/// A file of G-code in which the machine stopped, and the line (from 1) that it was at: what is carved before it is
/// done; the scratch that it was at, and what follows, is not.
struct Interruption {
  std::filesystem::path file;
  std::size_t line = 0;
};

struct ToolpathOptions {
  bool keep_order = false;  ///< carve in the file's order instead of the shortest
  double part_s = 0;        ///< split G-code into files of at most about this long; 0: as few files as max_lines allows
  std::optional<Interruption> after{};  ///< carve only what this file left, in its order
  bool frame = false;  ///< G-code: also a file that moves round the scratches at safe height, to see that they fit
};

/// One file of G-code: it sets up units and modes and lifts the tool before it moves, so that carving may begin with
/// any part.
struct GcodePart {
  std::string text;
  std::size_t first = 0, count = 0;  ///< which of Toolpath::scratches it carves
  double duration_s = 0;             ///< by replaying it (burin/optimize/carving/toolpath_check.h)
};

struct ToolpathReport {
  std::vector<std::filesystem::path> files;  ///< in the order to be carved; the frame, if asked for, comes last
  std::vector<double> file_duration_s;
  std::size_t scratch_count = 0;
  double duration_s = 0, carve_mm = 0, travel_mm = 0;
  double file_order_travel_mm = 0;  ///< what the travel would have been in the order of the scratches given
  Eigen::Vector2d min_mm, max_mm;
  std::vector<CarvingStep> order;
  bool compensated = false;
  std::size_t already_carved = 0;
  double stepped_mm = 0;
  std::size_t done_before = 0;
};

/// The rules that a tool path obeys. `measured` may be null.
CarvingLimits toolpath_limits(const Board& board, const Bench* measured, const MachineProfile& machine);

/// Orders and compensates what is not carved yet. `measured` may be null. Throws Error when there is nothing to carve,
/// for a scratch that breaks the rules of the board and the machine (burin/optimize/carving/carving_limits.h; judged as
/// the machine will carve it, on its steps), and for one whose compensated ends the machine cannot reach; each is named
/// by its row.
Toolpath plan_toolpath(const Scratches& scratches, const Board& board, const Bench* measured,
                       const MachineProfile& machine, const ToolpathOptions& options = {},
                       const Progress& progress = {});

/// What an interrupted file left of a tool path: its scratches from the one on that its `line` belongs to, in its
/// order. `planned` must hold all scratches of the file (it may hold more: other parts), `text` is the file's content.
/// By replay: what was carved before the line and what is left are together the file's scratches, once each. Throws
/// Error if the file carves anything that is not planned (another board, bench or machine), if the line is not in the
/// file, and if nothing or everything is left.
Toolpath left_after(const Toolpath& planned, const MachineProfile& machine, std::string_view text, std::size_t line,
                    const std::string& name);

/// Throws Error for a block of the profile with a placeholder that nobody knows.
std::vector<GcodePart> gcode_parts(const Toolpath& path, const MachineProfile& machine,
                                   const ToolpathOptions& options = {});

/// A way round all scratches at safe height, at the carving feed.
std::string frame_gcode(const Toolpath& path, const MachineProfile& machine);

/// SVG 1.1 in mm: width and height in mm, a viewBox in mm, y turned down so that the board is seen as it lies.
std::string svg(const Toolpath& path, const Eigen::Vector2d& board_size_mm, int decimals = 4);

/// DXF R12 in mm ($INSUNITS 4), a LINE for each scratch, y up.
std::string dxf(const Toolpath& path, int decimals = 4);

/// Plans and writes `out` by its extension: .gcode, .nc, .ngc, .svg or .dxf. G-code of several parts becomes
/// out-01.gcode, out-02.gcode, ...; parts that an earlier, longer run left behind are removed. G-code is replayed
/// before it is written: a scratch lost, doubled or mirrored is an Error and nothing is written. After an interruption
/// no other file is removed, and `out` may not be the interrupted one.
ToolpathReport write_toolpath(const Scratches& scratches, const Board& board, const Bench* measured,
                              const MachineProfile& machine, const ToolpathOptions& options,
                              const std::filesystem::path& out, const Progress& progress = {});

/// "30min", "45s", "2h", "1.5h", "1h30min" in seconds. Throws Error for anything else.
double duration_from_text(const std::string& text);

/// "6 h 20 min", "12 min", "40 s".
std::string duration_text(double seconds);

}  // namespace burin
