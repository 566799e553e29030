// burin/optimize/toolpath/release_check.h - whether G-code may be given to a machine: the one function that decides it.
//
// Tool paths, frames, probing files, coupons and what is left of an interrupted file are given out by its leave alone,
// and `burin check carve` and --replay ask it of files that are there already. It judges what the lines do, in places
// and heights, not how a profile's blocks are written:
//   sheet     X and Y lie on the sheet, or up to kBesideSheet_mm beside it
//   reach     and within the machine's travel_mm, if the profile has one
//   depth     Z goes no deeper below the face than the tip can cut or the machine's table presses, and never farther
//   from
//             zero than a clamped sheet tilts
//   standing  ways in the air clear keep-outs and the tags' paper; in the metal none runs into one
//   first way the first way along X and Y, and every way whose course the file does not tell, lies above all of it, and
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

/// By how far what is sent may lie beside the sheet: measured maps move places by some millimeters, and a tool crosses
/// an edge no farther.
inline constexpr double kBesideSheet_mm = 5;

/// Judges a file's ways one by one and keeps, for each kind of fault, the first and how many there are.
class ReleaseCheck {
 public:
  /// All three must outlive it.
  ReleaseCheck(const Workpiece& workpiece, const MachineProfile& machine, const Face& face);

  /// A move that may go anywhere but into the metal without `way.carves`.
  void judge(const ToolWay& way);
  /// A probing move, down to where it touches.
  void judge_touch(const ToolWay& way);
  /// What a whole file carves.
  void judge(const Replay& replay);

  /// Errors, one for each kind; `name` is what they call the file.
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

/// What a file does, and what speaks against giving it out.
struct ReleasedFile {
  Replay replay;
  std::vector<Finding> faults;
};

/// Follows a whole file as its machine would. Throws Error for what cannot be followed (replay_gcode()).
ReleasedFile check_release(std::string_view gcode, const MachineProfile& machine, const Workpiece& workpiece,
                           const Face& face, const std::string& name);

/// The same, and throws Error, naming the line, unless all of it may be given out.
Replay fail_unless_released(std::string_view gcode, const MachineProfile& machine, const Workpiece& workpiece,
                            const Face& face, const std::string& name);

/// A note for the time before there is G-code: a keep-out whose height nobody said. `board_file` is named.
std::vector<Finding> height_findings(const Board& board, const std::filesystem::path& board_file);

/// Notes of what nobody checked: a machine whose reach is not known.
std::vector<Finding> reach_findings(const MachineProfile& machine);

}  // namespace burin
