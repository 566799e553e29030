// burin/simulate/bent_sheet.h - a bent sheet for the simulated camera: rays against a true cylinder, and the sheet
// rolled about its axis. Independent of burin/scene/bend.h, which it validates. Frame: board, mm.
#pragma once

#include <Eigen/Geometry>
#include <optional>

namespace burin {

struct BentSheet {
  double radius_mm = 1;  ///< below 0: hollow
  Eigen::Vector2d size_mm{1, 1};
  Eigen::Vector3d axis{1, 0, 0};       ///< unit, through `center_mm`
  Eigen::Vector3d center_mm{0, 0, 0};  ///< center of the cylinder, below (or above) the sheet's middle

  BentSheet(double radius, double axis_deg, const Eigen::Vector2d& size);

  /// A place of the flat sheet after bending: the sheet's rotation there, and its new position.
  struct Place {
    Eigen::Matrix3d turn;  ///< takes the flat sheet's directions to those in space
    Eigen::Vector3d position_mm;
    Eigen::Vector3d normal() const { return turn.col(2); }
  };
  Place at(double x_mm, double y_mm) const;

  /// The first intersection of a ray with the front of the sheet, up to `beyond_mm` past its edges, as if the sheet
  /// continued. Nothing if the ray misses the sheet or meets the back first.
  std::optional<Eigen::Vector2d> first_met(const Eigen::Vector3d& origin_mm, const Eigen::Vector3d& ray,
                                           double beyond_mm) const;

  /// True if the sheet casts its own shadow on a place.
  bool shades(const Place& place, const Eigen::Vector3d& lamp_mm) const;
};

}  // namespace burin
