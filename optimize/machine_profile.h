// burin/optimize/machine_profile.h - a carving machine: its G-code, speeds and limits.
//
// Machine coordinates are the board's, in mm. Work zero is the lower-left corner of the carved face; x points right, y
// up, z out of the metal. The face is at z = 0 at the place of Z's zero setting. Built-in profiles: "grbl",
// "grbl-spring", "linuxcnc", "marlin" and "laser-z". The file of another machine has the format "burin/machine", in
// JSON or, if its name ends in .toml, in TOML. It lists the differences from the built-in profile in `based_on`:
//
//   { "format": "burin/machine", "version": 1, "name": "my router", "based_on": "grbl",
//     "carve_feed_mm_min": 900, "plunge_feed_mm_min": 200, "rapid_mm_min": 3000, "rapid_z_mm_min": 800,
//     "acceleration_mm_s2": 200, "acceleration_z_mm_s2": 80, "safe_z_mm": 1, "dwell_s": 0.05,
//     "decimals": 3, "max_lines": 90000, "max_line_characters": 79, "other_m_codes": [42],
//     "travel_mm": [[-10, -10], [400, 300]], "force": 350,
//     "limits": { "step_mm": 0.0125, "shortest_mm": 0.5, "longest_mm": 40, "min_distance_mm": 0.05,
//                 "max_overlap": 0.3, "max_grooves": 3 },
//     "depth_by": "spring", "depth_table": [[5, 0.25], [12, 0.6], [20, 1.2, 0.4]],
//     "head": ["; lines: {lines}"],
//     "start": ["G21", "G90", "M3 S{force}"], "per_scratch": ["G0 X{x0} Y{y0}", ...], "end": ["M5", "M2"] }
//
// TOML has the same keys before `=`, and `limits` is a table of its own.
//
// Blocks are lines with placeholders {name}:
//   everywhere      {z_safe} {feed} {plunge_feed} {rapid} {rapid_z} {force} {servo_up}
//   `per_scratch`   also {x0} {y0} {x1} {y1} {z_carve} {z1} {servo} {depth_um} {number}
//   `head`          also {lines} {time_s} {part} {parts} {scratches} {min_x} {max_x} {min_y} {max_y} {min_z} {max_z}
// {z_safe} is the Z of a travel move: safe_z_mm above the face, and higher if the move crosses an obstacle on the
// sheet. In `start` and `end` it is above all obstacles (burin/optimize/toolpath/workpiece.h). {z_carve} is below the
// face and therefore negative. {z1} is the same at the other end, if Z follows the face's height. A head that presses
// with a force instead of a depth uses {force} or {depth_um}. A line with {dwell_s} or {dwell_ms} is left out if the
// profile has no dwell. `head` precedes everything else, for controllers that read a header there. Its {lines} count
// the whole file, and its {min_x} to {max_z} bound the tool's positions.
//
// Burin writes lines of its own before `start` and `end`, whatever the blocks contain. They turn a laser's beam off (M5
// S0; Marlin: M5, M107) and lift a servo's head. LinuxCNC passes through every end (G61). Marlin's software endstops
// let Z below zero (M211 S0, at the end S1).
//
// `depth_by` names the origin of the depth:
//   "fixed-z"  Z goes to the depth itself. The face must be even to a part of the depth, or Z follows a height map.
//   "spring"   The tool is pressed by moving below the first contact, by the preload of depth_table. A row is
//              [depth um, mm], with the depth's standard deviation in um if it was measured.
//   "drag"     The same, by a drag bit's own spring.
//   "servo"    An S value presses the head ([depth um, S]). Z stays at the safe height.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "burin/optimize/depth_table.h"
#include "burin/optimize/machine_measured.h"

namespace burin {

class JsonObject;

/// G-code dialects: they differ in comments and dwells.
enum class GcodeDialect {
  grbl,      ///< comments in ( ), G4 P in seconds
  linuxcnc,  ///< the same
  marlin,    ///< comments after ;, G4 P in milliseconds (only Marlin knows S in seconds; Klipper knows P)
};

/// Origin of the depth (see above).
enum class DepthBy { fixed_z, spring, drag, servo };

/// "fixed-z", "spring", "drag" or "servo".
const char* depth_by_name(DepthBy depth_by);

/// Whether Z goes below the first contact by the machine's table.
inline bool by_preload(DepthBy depth_by) { return depth_by == DepthBy::spring || depth_by == DepthBy::drag; }

/// Reach of a machine, mm in its own frame.
struct MachineBounds {
  Eigen::Vector2d min_mm{0, 0}, max_mm{0, 0};
};

/// Limits of the machine and its cutter; 0: no such limit. burin/optimize/toolpath/carving_limits.h defines them
/// exactly.
struct MachineLimits {
  double step_mm = 0;      ///< both commanded ends are multiples of it
  double shortest_mm = 0;  ///< of a scratch
  double longest_mm = 0;
  double distance_mm = 0;  ///< least distance between scratches without a crossing
  double max_overlap = 0;  ///< largest share of a groove cut away by others
  int max_grooves = 0;     ///< over one place
};

/// A carving machine: the content of its files, and its speeds.
struct MachineProfile {
  std::string name = "grbl";
  GcodeDialect dialect = GcodeDialect::grbl;
  DepthBy depth_by = DepthBy::fixed_z;
  double carve_feed_mm_min = 1200;
  double plunge_feed_mm_min = 300;
  double rapid_mm_min = 3000;         ///< in the air, along the board
  double rapid_z_mm_min = 1000;       ///< up, and down through the air
  double acceleration_mm_s2 = 200;    ///< along the board
  double acceleration_z_mm_s2 = 100;  ///< up and down
  double safe_z_mm = 1;               ///< height of travel above the face: clear of tags and of the board's warp
  double dwell_s = 0;                 ///< settling time at the bottom before the scratch begins
  int decimals = 4;                   ///< of coordinates; 4 keeps a 1 mm scratch's direction to 0.004 degrees
  int max_lines = 95000;              ///< per file; longer jobs are split. 0: no limit
  int max_line_characters = 0;        ///< longest line of the controller, without its end. 0: its dialect's
  bool laser = false;                 ///< the tool replaces a laser: no file may turn the beam on
  std::vector<int> other_m_codes;     ///< additional M codes permitted in its files; they move nothing
  double force = 0;                   ///< of heads that press, in the unit of {force} in the blocks
  DepthTable depth_table;             ///< of spring, drag and servo
  double servo_up = 0;                ///< S that lifts a servo's head
  MachineLimits limits;
  std::optional<MachineMeasured> measured;  ///< by a coupon
  /// Reach of the tool from work zero (a file's travel_mm less its work_zero_mm). Without it nothing is checked.
  std::optional<MachineBounds> travel;
  bool travel_is_unknown = false;  ///< a person declared it unknown: no note asks for it
  std::vector<std::string> head, start, per_scratch, end;
};

/// Reads `travel_mm` (and `work_zero_mm`): [[x, y], [x, y]], or "unknown". A missing key leaves its value.
void read_travel(JsonObject& json, MachineProfile& machine);

/// The smallest `max_lines`: shorter files would consist of little but their heads.
inline constexpr int kLeastLines = 100;

/// The names of the built-in profiles as a sentence lists them: "grbl, grbl-spring, ... or laser-z".
std::string built_in_machines();

/// A built-in profile by its name, or the profile of a "burin/machine" file. Throws Error with the list of built-in
/// names.
MachineProfile machine_profile(const std::string& name_or_file);

/// Distance of Z below the face for a depth, mm: the depth itself, or its preload; 0 for servos. Throws Error for a
/// depth beyond the machine's table.
double plunge_mm(const MachineProfile& machine, double depth_mm);

/// Whether an M code (in tenths) switches nothing on, on any controller. The file of a laser or servo may hold only
/// these codes: any other one may switch a beam, or another head.
bool switches_nothing_on(int m_tenths);

/// Whether a servo's head is up at this S or beyond it, away from the pressing side.
bool lifts_servo(const MachineProfile& machine, double command);

/// The inverse of plunge_mm: the depth for Z this far below the face, mm; NaN beyond the table.
double depth_of_plunge_mm(const MachineProfile& machine, double below_mm);

/// Whether a head presses without a trace in the file (a solenoid, air). Z does not affect the depth, and moves of its
/// blocks along the board are scratches above the face as well.
bool presses_by_itself(const MachineProfile& machine);

/// Whether Z stays during carving: no line of `per_scratch` lifts to {z_safe}.
bool keeps_z(const MachineProfile& machine);

/// Throws Error naming file, field, value and remedy, and the line of a TOML file.
MachineProfile read_machine_profile(const std::filesystem::path& file);

/// Time to move `length` mm from rest to rest with a trapezoidal speed profile: constant acceleration up to the feed.
/// The profile is a triangle if the path is too short to reach the feed.
double move_time_s(double length_mm, double feed_mm_min, double acceleration_mm_s2);

}  // namespace burin
