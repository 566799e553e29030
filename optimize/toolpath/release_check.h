// burin/optimize/toolpath/release_check.h - the one function that decides if G-code may be given to a machine.
//
// Tool paths, frames, probing files, coupons and remainders of interrupted files need its approval before they are
// written. `burin check carve` and --replay apply it to existing files. It judges the effect of lines, in places and
// heights, not the text of a profile's blocks:
//   sheet     X and Y lie on the sheet, or up to kBesideSheet_mm outside of it
//   reach     and within the machine's travel_mm, if the profile has one
//   depth     Z goes no deeper below the face than the tip can cut or the machine's table presses, and never farther
//             from zero than a clamped sheet tilts
//   standing  ways in the air clear keep-outs and the tags' paper; ways in the metal do not meet any
//   first way the first way along X and Y, and every way with an unknown course, is above all obstacles, and
//             kFirstWay_mm above the face
// Frame: the machine's (burin/optimize/machine_profile.h), mm.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "burin/base/finding.h"
#include "burin/optimize/toolpath/toolpath_check.h"
#include "burin/optimize/toolpath/workpiece.h"

namespace burin {

/// Largest distance of commanded places from the sheet: measured maps move places by some millimeters, and a tool
/// crosses an edge by no more.
inline constexpr double kBesideSheet_mm = 5;

/// Judges a file's ways one by one, and keeps the first fault of each kind and their number.
class ReleaseCheck {
 public:
  /// All three must outlive it.
  ReleaseCheck(const Workpiece& workpiece, const MachineProfile& machine, const Face& face);

  /// Judges a move, which may enter the metal only with `way.carves`.
  void judge(const ToolWay& way);
  /// Judges a probing move, down to its touch.
  void judge_touch(const ToolWay& way);
  /// Judges the carving of a whole file.
  void judge(const Replay& replay);

  /// Errors, one per kind; `name` is the file's name in them.
  std::vector<Finding> findings(const std::string& name) const;
  /// Throws Error for the first of them in the file.
  void fail_unless_safe(const std::string& name) const;

 private:
  struct Fault {
    std::size_t line = 0, count = 0;
    std::string what, remedy;
  };
  enum Kind { kOffSheet, kDepth, kTooHigh, kStanding, kFirstWay, kUnknownHeight, kKinds };

  void add(Kind kind, std::size_t line, const std::string& what, const std::string& remedy);
  void judge_place(const ToolWay& way);
  void judge_depth(const ToolWay& way);
  void judge_course(const ToolWay& way);
  void judge_unknown_course(const ToolWay& way);
  double tip_mm(const Eigen::Vector3d& p) const;

  const Workpiece& workpiece_;
  const MachineProfile& machine_;
  const Face& face_;
  double first_z_mm_ = 0, rounding_mm_ = 0;
  Fault faults_[kKinds];
};

/// Effect of a file, and objections against its release.
struct ReleasedFile {
  Replay replay;
  std::vector<Finding> faults;
};

/// Follows a whole file as its machine would. Throws Error if it cannot be followed (replay_gcode()).
ReleasedFile check_release(std::string_view gcode, const MachineProfile& machine, const Workpiece& workpiece,
                           const Face& face, const std::string& name);

/// Follows a whole file, and throws Error, naming the line, unless all of it may be released.
Replay fail_unless_released(std::string_view gcode, const MachineProfile& machine, const Workpiece& workpiece,
                            const Face& face, const std::string& name);

/// A note for the time before there is G-code: a keep-out without a height. `board_file` is named.
std::vector<Finding> height_findings(const Board& board, const std::filesystem::path& board_file);

/// Notes about missing data: a machine with unknown reach.
std::vector<Finding> reach_findings(const MachineProfile& machine);

}  // namespace burin
