// burin/optimize/machine_profile.h - what a carving machine understands and how fast it moves.
//
// Machine coordinates are the board's: work zero at the lower-left corner of the carved face, x right, y up, z out of
// the metal, mm; the face is z = 0 where Z was set to zero. Built-in: "grbl", "grbl-spring", "linuxcnc", "marlin" and
// "laser-z". A person's own machine is a file in JSON or, if its name ends in .toml, in TOML, format "burin/machine",
// that says what differs from the built-in profile it is `based_on`:
//
//   { "format": "burin/machine", "version": 1, "name": "my router", "based_on": "grbl",
//     "carve_feed_mm_min": 900, "plunge_feed_mm_min": 200, "rapid_mm_min": 3000, "rapid_z_mm_min": 800,
//     "acceleration_mm_s2": 200, "acceleration_z_mm_s2": 80, "safe_z_mm": 1, "dwell_s": 0.05,
//     "decimals": 3, "max_lines": 90000, "max_line_characters": 79, "other_m_codes": [42], "travel_mm": [[-10, -10],
//     [400, 300]], "force": 350, "limits": { "step_mm": 0.0125, "shortest_mm": 0.5, "longest_mm": 40,
//     "min_distance_mm": 0.05,
//                 "max_overlap": 0.3, "max_grooves": 3 },
//     "depth_by": "spring", "depth_table": [[5, 0.25], [12, 0.6], [20, 1.2, 0.4]],
//     "head": ["; lines: {lines}"],
//     "start": ["G21", "G90", "M3 S{force}"], "per_scratch": ["G0 X{x0} Y{y0}", ...], "end": ["M5", "M2"] }
//
// In TOML the same keys stand before `=`, and `limits` is a table of its own.
//
// {z_safe} is Z of the ways beside its line: safe_z_mm above the face, higher where a way crosses what stands on the
// sheet, and in `start` and `end` above all of it (burin/optimize/toolpath/workpiece.h).
//
// Blocks are lines in which {name} is replaced: {z_safe} {feed} {plunge_feed} {rapid} {rapid_z} {force} everywhere, and
// in `per_scratch` also {x0} {y0} {x1} {y1} {z_carve} (below the face, so negative) {z1} (the same at the other end,
// where the face's height is followed) {servo} {depth_um} {number}; {servo_up} everywhere. Heads that press with a
// force instead of going to a depth put {force} or {depth_um} where they need it. A line that holds {dwell_s} or
// {dwell_ms} is left out where the profile has no dwell. `head` comes before all else, for controllers that read a
// header there; it may also hold {lines} (of the whole file), {time_s}, {part}, {parts}, {scratches} and the places
// that the tool is sent to: {min_x} {max_x} {min_y} {max_y} {min_z} {max_z}.
//
// Before `start` and `end` stand lines of Burin's own, whatever the blocks hold: a laser's beam is off (M5 S0; Marlin:
// M5, M107), a servo's head is up, LinuxCNC goes through every end (G61), Marlin's software endstops let Z below zero
// (M211 S0, at the end S1).
//
// `depth_by` says how a depth comes about:
//   "fixed-z"  Z goes to the depth itself, so the face must be as even as a part of that, or be followed (a height map)
//   "spring"   the tool is pressed by going below the first contact, as far as depth_table says ([depth um, mm], and
//              the depth's standard deviation, um, where it was measured)
//   "drag"     the same, by a drag bit's own spring
//   "servo"    an S value presses the head ([depth um, S]); Z stays at the safe height
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

/// What differs between G-code's dialects: how comments and dwells are written.
enum class GcodeDialect {
  grbl,      ///< comments in ( ), G4 P in seconds
  linuxcnc,  ///< the same
  marlin,    ///< comments after ;, G4 P in milliseconds (S in seconds is Marlin's alone; Klipper knows P)
};

/// How a depth comes about (see above).
enum class DepthBy { fixed_z, spring, drag, servo };

/// "fixed-z", "spring", "drag" or "servo".
const char* depth_by_name(DepthBy depth_by);

/// Whether Z goes below the first contact by the machine's table.
inline bool by_preload(DepthBy depth_by) { return depth_by == DepthBy::spring || depth_by == DepthBy::drag; }

/// What a machine reaches, mm in its own frame.
struct MachineBounds {
  Eigen::Vector2d min_mm{0, 0}, max_mm{0, 0};
};

/// What the machine and its cutter can do to a board; 0: no such limit. burin/optimize/toolpath/carving_limits.h says
/// what each means exactly.
struct MachineLimits {
  double step_mm = 0;      ///< both ends lie on multiples of it, as the machine is told them
  double shortest_mm = 0;  ///< scratch
  double longest_mm = 0;
  double distance_mm = 0;  ///< least distance between scratches that do not cross
  double max_overlap = 0;  ///< largest share of a groove that others cut away
  int max_grooves = 0;     ///< over one place
};

/// A carving machine: what its files look like, and how fast it moves.
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
  double safe_z_mm = 1;               ///< height of travel above the face: clear of tags and of the board's bow
  double dwell_s = 0;                 ///< settling time at the bottom before the scratch begins
  int decimals = 4;                   ///< of coordinates; 4 keeps a 1 mm scratch's direction to 0.004 degrees
  int max_lines = 95000;              ///< a file; longer jobs are split. 0: no limit
  int max_line_characters = 0;        ///< a line that the controller reads, without its end. 0: its dialect's
  bool laser = false;                 ///< the tool sits on a laser's axis: no file may turn the beam on
  std::vector<int> other_m_codes;     ///< M codes that its files may hold beside the usual: they move nothing
  double force = 0;                   ///< of heads that press, in the unit that {force} has in the blocks
  DepthTable depth_table;             ///< of spring, drag and servo
  double servo_up = 0;                ///< S that lifts a servo's head
  MachineLimits limits;
  std::optional<MachineMeasured> measured;  ///< by a coupon
  /// Where the tool can go, from work zero (a file's travel_mm less its work_zero_mm); nothing is checked if not known.
  std::optional<MachineBounds> travel;
  bool travel_is_unknown = false;  ///< a person has said that it is not known: no note asks for it
  std::vector<std::string> head, start, per_scratch, end;
};

/// Reads `travel_mm` (and `work_zero_mm`): [[x, y], [x, y]], or "unknown". What is not there stays.
void read_travel(JsonObject& json, MachineProfile& machine);

/// The least that `max_lines` may be: shorter files would be little but their own heads.
inline constexpr int kLeastLines = 100;

/// The names of the built-in profiles, as a sentence lists them: "grbl, grbl-spring, ... or laser-z".
std::string built_in_machines();

/// A built-in profile by its name, or the path of a "burin/machine" file. Throws Error naming what there is.
MachineProfile machine_profile(const std::string& name_or_file);

/// How far below the face Z goes for a depth, mm: the depth itself, or the preload that makes it; 0 for servos. Throws
/// Error for a depth beyond the machine's table.
double plunge_mm(const MachineProfile& machine, double depth_mm);

/// Whether an M code (in tenths) switches on nothing, on any controller: the codes that a laser's or a servo's file may
/// hold. Any other one may be a beam, or another head.
bool switches_nothing_on(int m_tenths);

/// Whether a servo's head is up at this S or beyond it, on the side that does not press.
bool lifts_servo(const MachineProfile& machine, double command);

/// The other way: the depth that Z so far below the face makes, mm; NaN beyond the table.
double depth_of_plunge_mm(const MachineProfile& machine, double below_mm);

/// Whether a head presses by itself where the file cannot see it (a solenoid, air): Z is no part of the depth, and the
/// moves of its blocks along the board are scratches above the face as well.
bool presses_by_itself(const MachineProfile& machine);

/// Whether Z stays while scratches are carved: no line of `per_scratch` lifts to {z_safe}.
bool keeps_z(const MachineProfile& machine);

/// Throws Error naming file, field, value and remedy, and of a TOML file the line.
MachineProfile read_machine_profile(const std::filesystem::path& file);

/// Time to go `length` mm from rest to rest with a trapezoidal profile: constant acceleration up to the feed (a
/// triangle where the way is too short to reach it).
double move_time_s(double length_mm, double feed_mm_min, double acceleration_mm_s2);

}  // namespace burin
