// burin/optimize/toolpath/workpiece.h - the sheet for the tool: its size, obstacles on it and their heights, the depth
// limit of the tip, and the necessary height of ways. Planning and checks share these functions. Frames: `standing` the
// board's; ways the machine's (burin/optimize/machine_profile.h), mm.
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

/// A place without grooves on the sheet, and its bounding box, which most ways miss.
struct Standing {
  KeepOut place;  ///< its height is known
  Eigen::AlignedBox2d box;
};

/// The sheet on the machine, with everything that the tool must clear.
struct Workpiece {
  Eigen::Vector2d size_mm{0, 0};   ///< of the sheet
  std::vector<Standing> standing;  ///< keep-outs and the tags' paper, each with its height
  std::string unknown;             ///< a keep-out without a height: no tool may be sent; empty if there is none
  double paper_mm = 0;             ///< thickness of the tags' paper; 0 without tags
  double deepest_mm = 0;           ///< deepest groove of the tip: its radius, wt / 4
  bool lags = false;  ///< the machine has backlash or uneven screws: `lands` is accurate to some hundredths
  Eigen::Matrix<double, 2, 3> lands = Eigen::Matrix<double, 2, 3>::Identity();  ///< machine's place -> board's
};

/// `measured` may be null.
Workpiece workpiece_of(const Board& board, const Bench* measured);

/// Clearance of a way above an obstacle: the accuracy of a person's ruler and a clamp's screw.
inline constexpr double kOverStanding_mm = 1, kOverPaper_mm = 0.2;
/// Lateral clearance of a lower way in the air from an obstacle: the tool has an extent.
inline constexpr double kBesideStanding_mm = 2;
/// Height above face and clamps of the first way along X and Y: it starts at the tool's position, which no file knows.
inline constexpr double kFirstWay_mm = 5;

/// The first obstacle on the sheet, of any height, on the way or within `beside_mm` of it; null if none.
const KeepOut* standing_under(const Workpiece& workpiece, const Eigen::Vector2d& from_mm, const Eigen::Vector2d& to_mm,
                              double beside_mm);

/// Height above the face of a way from a to b over obstacles on the way or near it; 0 without any. With `beside_mm` 0:
/// obstacles directly below only.
double height_needed_mm(const Workpiece& workpiece, const Eigen::Vector2d& from_mm, const Eigen::Vector2d& to_mm,
                        double beside_mm = kBesideStanding_mm);

/// Height above the face that clears all obstacles on the sheet.
double height_over_all_mm(const Workpiece& workpiece);

/// Z of a way from one place to another: safe_z_mm above all of the face on the way, and clear of the tags' paper and
/// of obstacles there.
double travel_z_mm(const Workpiece& workpiece, const Face& face, const MachineProfile& machine,
                   const Eigen::Vector2d& from_mm, const Eigen::Vector2d& to_mm);

/// Z of the first way along X and Y, and of the last: above the highest place of the face, all obstacles on it, and
/// kFirstWay_mm more.
double first_z_mm(const Workpiece& workpiece, const Face& face, const MachineProfile& machine);

/// Deepest permitted Z below the face, mm: the tip's limit, or the last preload of the machine's table.
double deepest_plunge_mm(const Workpiece& workpiece, const MachineProfile& machine);

}  // namespace burin
