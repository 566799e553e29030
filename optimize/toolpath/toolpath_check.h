// burin/optimize/toolpath/toolpath_check.h - replay of a G-code file: its effect on a machine.
//
// The replay follows G0, G1, G4, G20, G21, G90, F, and X Y Z words, comments, line numbers and % of the machine's
// dialect (gcode_line.h). It skips codes without motion (M, S, T, G17, G40, G61, G64, G80, G94, ...). G28, G30 and G53
// go to places unknown to the file.
//
// Lines are errors, with their number, if a controller would misread them or if they would make the replay wrong:
// - arcs, relative coordinates, changes of units, plane or offsets;
// - unknown codes and words, invalid feeds, too long numbers and lines, bytes other than ASCII;
// - ways outside the machine's travel, and any content behind the end.
//
// Depths come from Z, from the machine's table if the machine presses (a preload, a servo's S by M3, M4, M67, M68 or
// M280), and from the face's height if a path follows one. Straight strokes without a lift between them are then one
// scratch. Metal is everything below the face, for any blocks of a profile. A laser's file must turn the beam off, and
// a servo's must lift the head, before any move; neither may switch another output. LinuxCNC needs exact ends (G61, or
// G64 with a tolerance of some um), and Marlin needs Z below zero (M211 S0). Machine coordinates
// (burin/optimize/machine_profile.h), mm.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "burin/optimize/machine_profile.h"
#include "burin/optimize/toolpath/gcode_line.h"
#include "burin/optimize/toolpath/planned_path.h"

namespace burin {

/// One stroke in the metal: a straight move along the board below its face.
struct ReplayedScratch {
  Eigen::Vector2d from_mm, to_mm;
  double depth_mm = 0;         ///< NaN for a pressing head: not in the file
  std::size_t line = 0;        ///< of the file, from 1: the last line of its stroke
  double depth_spread_mm = 0;  ///< largest deviation from depth_mm, up or down, along the scratch
};

/// One move, as a line of the file makes it. NaN: a coordinate unknown to the file.
struct ToolWay {
  Eigen::Vector3d from_mm, to_mm;
  std::size_t line = 0;  ///< of the file, from 1
  bool carves = false;   ///< along the board in the metal, or with the head pressed down
};

/// What a G-code file carves, from a replay of its lines.
struct Replay {
  std::vector<ReplayedScratch> scratches;
  Eigen::Vector3d min_mm, max_mm;      ///< of all commanded places; NaN for an axis never named
  double carve_mm = 0, travel_mm = 0;  ///< along the board, in the metal and above it
  /// Least height above the face of a way along the board in the air; infinite if there is none or if it is unknown.
  double lowest_travel_mm = std::numeric_limits<double>::infinity();
  double duration_s = 0;  ///< each move from rest to rest, with the profile's accelerations; dwells included
  std::size_t lines = 0;
  bool ended = false;             ///< by M2, M30 or LinuxCNC's second %
  std::optional<GcodeHead> head;  ///< head of one of Burin's files
};

/// Replays a file; `name` is its name in errors. `face` is the followed face; null: an even one. `each_way` is called
/// for every move of the file, also to home and to places of the machine. Throws Error for:
/// - lines without a defined effect;
/// - a move before units (G20 or G21) and absolute coordinates (G90) are set;
/// - a move along the board before the tool was lifted or placed;
/// - a rapid move (G0) into or through the metal, and a way in the air in contact with the face;
/// - holes: the tool goes down and up and carves nothing;
/// - an end below the face, and a beam or a spindle left on.
Replay replay_gcode(std::string_view text, const MachineProfile& machine, const std::string& name,
                    const Face* face = nullptr, const std::function<void(const ToolWay&)>& each_way = {});

/// Comparison of a replay with the plan.
struct ToolpathCheck {
  std::size_t lost = 0;                                ///< planned and not carved
  std::size_t doubled = 0;                             ///< carved more than once
  std::size_t foreign = 0;                             ///< carved and not planned (or at another depth)
  std::size_t mirrored = 0;                            ///< number of lost ones found with a mirrored x (or y)
  std::size_t first_lost = 0, first_foreign_line = 0;  ///< row of the first lost one; line of the first foreign one

  /// True if the file carves each scratch once and nothing else.
  bool good() const { return lost == 0 && doubled == 0 && foreign == 0; }
};

/// Compares ends (in either order) and depths within the tolerance. Depths may deviate by an additional `depth_share`
/// of the plan (depth_share(face)).
ToolpathCheck check_toolpath(std::span<const ReplayedScratch> carved, std::span<const PlannedScratch> planned,
                             double tolerance_mm, double depth_share = 0);

/// The planned scratch of each carved stroke, or -1. Ends (in either order) and depths must agree within the tolerance;
/// a tolerance above 0 for depths may be another one. Strokes planned several times match different scratches.
std::vector<std::ptrdiff_t> find_planned(std::span<const ReplayedScratch> carved,
                                         std::span<const PlannedScratch> planned, double tolerance_mm,
                                         double depth_share = 0, double depth_tolerance_mm = 0);

/// Throws Error for a file without an end, if its machine's files have one. Also throws if one of Burin's files carves
/// fewer or more scratches than its head names: it was cut off, or joined with another.
void fail_unless_ended(const Replay& replay, const MachineProfile& machine, const std::string& name);

/// Throws Error with the fault unless the check is good.
void fail_unless_good(const ToolpathCheck& check, const std::string& name);

}  // namespace burin
