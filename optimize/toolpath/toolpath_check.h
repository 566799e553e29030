// burin/optimize/toolpath/toolpath_check.h - reads a G-code file as a machine would, and says what it would do.
//
// What is followed: G0, G1, G4, G20, G21, G90, F, and X Y Z words, comments, line numbers and % as the machine's
// dialect has them (gcode_line.h). What does not move anything (M, S, T, G17, G40, G61, G64, G80, G94, ...) is passed
// over; G28, G30 and G53 go somewhere that the file does not tell. Everything that a controller would misread, or that
// would make the replay wrong, is an error that names the line: arcs, relative coordinates, changes of units, plane or
// offsets, unknown codes and words, feeds that are none, numbers too long, lines too long, bytes that are not ASCII,
// ways outside the machine's travel, and anything behind the end. Depths are told from Z, from the machine's table
// where it presses (a preload, a servo's S by M3, M4, M67, M68 or M280), and from the face's height where a path
// follows one: strokes that go on without a lift in a straight line are then one scratch. Below the face is metal,
// whatever a profile's blocks look like. A laser's file has to turn the beam off and a servo's to lift the head before
// anything moves, and neither may switch another output. LinuxCNC must be told to go through the ends (G61, or G64 with
// a tolerance of some um), and Marlin to let Z below zero (M211 S0). Machine coordinates
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
  double depth_mm = 0;         ///< NaN for a head that presses instead of plunging: the file does not tell
  std::size_t line = 0;        ///< of the file, from 1: the last line of its stroke
  double depth_spread_mm = 0;  ///< by how much the depth leaves depth_mm, up or down, along the scratch
};

/// One move, as a line of the file makes it. NaN: a place that the file does not tell.
struct ToolWay {
  Eigen::Vector3d from_mm, to_mm;
  std::size_t line = 0;  ///< of the file, from 1
  bool carves = false;   ///< along the board in the metal, or with the head pressed down
};

struct Replay {
  std::vector<ReplayedScratch> scratches;
  Eigen::Vector3d min_mm, max_mm;      ///< of all places the tool was sent to; NaN for an axis never named
  double carve_mm = 0, travel_mm = 0;  ///< along the board, in the metal and above it
  /// Least height above the face of a way along the board in the air; infinite where there is none or it is not told.
  double lowest_travel_mm = std::numeric_limits<double>::infinity();
  double duration_s = 0;  ///< each move from rest to rest, with the profile's accelerations; dwells included
  std::size_t lines = 0;
  bool ended = false;             ///< by M2, M30 or LinuxCNC's second %
  std::optional<GcodeHead> head;  ///< what a file of Burin's tells of itself
};

/// Replays a file. `name` is what errors call it. Throws Error for what cannot be followed, for a move before units
/// (G20 or G21) and absolute coordinates (G90) are set, for a move along the board before the tool was lifted or
/// placed, for a rapid move (G0) into or through the metal, for ways in the air that touch the face, for holes (the
/// tool goes down and up and carves nothing), for an end below the face, and for a beam or a spindle left on. `face`:
/// that the file follows; without one it is even. `each_way` is called for
/// every move that the file makes, ways home and to places of the machine among them.
Replay replay_gcode(std::string_view text, const MachineProfile& machine, const std::string& name,
                    const Face* face = nullptr, const std::function<void(const ToolWay&)>& each_way = {});

/// What a replay did against what was planned.
struct ToolpathCheck {
  std::size_t lost = 0;      ///< planned and not carved
  std::size_t doubled = 0;   ///< carved more than once
  std::size_t foreign = 0;   ///< carved and not planned (or at another depth)
  std::size_t mirrored = 0;  ///< of those lost, how many are found when the file's x (or y) is turned round
  std::size_t first_lost = 0, first_foreign_line = 0;  ///< row of the first lost one; line of the first foreign one

  bool good() const { return lost == 0 && doubled == 0 && foreign == 0; }
};

/// Compares ends (in either order) and depths within the tolerance; depths may leave what was planned by `depth_share`
/// of it more (depth_share(face)).
ToolpathCheck check_toolpath(std::span<const ReplayedScratch> carved, std::span<const PlannedScratch> planned,
                             double tolerance_mm, double depth_share = 0);

/// For each carved stroke which of the planned ones it is (ends in either order, and depths, within the tolerance; a
/// tolerance above 0 for depths may be another one), different ones for strokes planned several times; -1 for one that
/// was not planned.
std::vector<std::ptrdiff_t> find_planned(std::span<const ReplayedScratch> carved,
                                         std::span<const PlannedScratch> planned, double tolerance_mm,
                                         double depth_share = 0, double depth_tolerance_mm = 0);

/// Throws Error for a file that has no end though its machine's files have one, and for one of Burin's that carves
/// fewer scratches than its head names, or more: it was cut off, or joined with another.
void fail_unless_ended(const Replay& replay, const MachineProfile& machine, const std::string& name);

/// Throws Error saying what is wrong, unless the check is good.
void fail_unless_good(const ToolpathCheck& check, const std::string& name);

}  // namespace burin
