// burin/optimize/toolpath/workpiece.h - the sheet as a tool meets it: how large it is, what stands on it and how high,
// how deep the tip may go, and how high a way must lie. Whoever plans ways and whoever judges them asks here. Frames:
// `standing` the board's; ways the machine's (burin/optimize/machine_profile.h), mm.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "burin/optimize/machine_profile.h"
#include "burin/optimize/toolpath/face.h"
#include "burin/scene/bench.h"
#include "burin/scene/board.h"

namespace burin {

/// A place on the sheet where nothing is carved, and the box round it, which most ways pass by.
struct Standing {
  KeepOut place;  ///< its height is known
  Eigen::AlignedBox2d box;
};

struct Workpiece {
  Eigen::Vector2d size_mm{0, 0};   ///< of the sheet
  std::vector<Standing> standing;  ///< keep-outs and the tags' paper, each with its height
  std::string unknown;             ///< a keep-out whose height nobody said: no tool may be sent; empty if there is none
  double paper_mm = 0;             ///< the tags' paper is this thick; 0 where there are no tags
  double deepest_mm = 0;           ///< groove that the tip can cut: its radius, wt / 4
  bool lags = false;               ///< the machine has backlash or uneven screws: `lands` is right to some hundredths
  Eigen::Matrix<double, 2, 3> lands = Eigen::Matrix<double, 2, 3>::Identity();  ///< machine's place -> board's
};

/// `measured` may be null.
Workpiece workpiece_of(const Board& board, const Bench* measured);

/// By how much a way clears what stands there: a person's ruler and a clamp's screw are that good.
inline constexpr double kOverStanding_mm = 1, kOverPaper_mm = 0.2;
/// By how far a way in the air keeps beside what stands there, if it lies lower: the tool is no line.
inline constexpr double kBesideStanding_mm = 2;
/// Height above face and clamps of the first way along X and Y, which comes from wherever the tool stands: no file
/// knows what is there.
inline constexpr double kFirstWay_mm = 5;

/// The first place on the sheet, of whatever height, that a way runs over, or past within `beside_mm`; null if none.
const KeepOut* standing_under(const Workpiece& workpiece, const Eigen::Vector2d& from_mm, const Eigen::Vector2d& to_mm,
                              double beside_mm);

/// Height above the face that a way from a to b needs for what stands under it or beside it; 0 if nothing does. With
/// `beside_mm` 0: only what stands right under it.
double height_needed_mm(const Workpiece& workpiece, const Eigen::Vector2d& from_mm, const Eigen::Vector2d& to_mm,
                        double beside_mm = kBesideStanding_mm);

/// Height above the face that clears all that stands on the sheet.
double height_over_all_mm(const Workpiece& workpiece);

/// Z of a way from one place to another: safe_z_mm above all of the face on the way, and clear of the tags' paper and
/// of what stands there.
double travel_z_mm(const Workpiece& workpiece, const Face& face, const MachineProfile& machine,
                   const Eigen::Vector2d& from_mm, const Eigen::Vector2d& to_mm);

/// Z of the first way along X and Y, and of the last: above the highest place of the face, all that stands on it, and
/// kFirstWay_mm more.
double first_z_mm(const Workpiece& workpiece, const Face& face, const MachineProfile& machine);

/// The deepest that Z may lie below the face, mm: what the tip can cut, or the last preload of the machine's table.
double deepest_plunge_mm(const Workpiece& workpiece, const MachineProfile& machine);

}  // namespace burin
