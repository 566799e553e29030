// burin/simulate/bent_sheet.h - a bent sheet as the simulated camera sees it: rays against a true cylinder,
// and the sheet turned about its axis. Written apart from burin/scene/bend.h, which it judges. Frame: board, mm.
#pragma once

#include <Eigen/Geometry>
#include <optional>

namespace burin {

struct BentSheet {
  double radius_mm = 1;  ///< below 0: hollow
  Eigen::Vector2d size_mm{1, 1};
  Eigen::Vector3d axis{1, 0, 0};       ///< unit, through `center_mm`
  Eigen::Vector3d center_mm{0, 0, 0};  ///< the cylinder's, below (or above) the sheet's middle

  BentSheet(double radius, double axis_deg, const Eigen::Vector2d& size);

  /// A place of the flat sheet after bending: the turn of the sheet there, and where it went.
  struct Place {
    Eigen::Matrix3d turn;  ///< takes the flat sheet's directions to those in space
    Eigen::Vector3d position_mm;
    Eigen::Vector3d normal() const { return turn.col(2); }
  };
  Place at(double x_mm, double y_mm) const;

  /// Where a ray first meets the sheet from its front; up to `beyond_mm` past its edges as if it went on there. Nothing
  /// where it passes, or meets the back first.
  std::optional<Eigen::Vector2d> first_met(const Eigen::Vector3d& origin_mm, const Eigen::Vector3d& ray,
                                           double beyond_mm) const;

  /// Whether the sheet throws its own shadow on a place.
  bool shades(const Place& place, const Eigen::Vector3d& lamp_mm) const;
};

}  // namespace burin
