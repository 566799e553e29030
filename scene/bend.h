// burin/scene/bend.h - a sheet that was carved flat and bent to a cylinder afterwards. docs/model.md 1.3.
//
// Flat place: where something lies on the flat sheet, mm, as scratches.csv and board.json have it. Bending keeps
// lengths on the sheet, so a flat place stays where it is on the metal. Frame: board, mm; the sheet's middle keeps its
// place and normal. Only what lies in front of the sheet as seen from +z is its face.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

namespace burin {

/// How a sheet is bent.
struct Bend {
  double radius_mm = 0;  ///< of the face; above 0: convex towards the viewer, below 0: hollow; never 0
  double axis_deg = 0;   ///< the cylinder's direction on the board, from +x counter-clockwise; modulo 180
};

/// A bent sheet, ready to be asked.
struct Cylinder {
  Eigen::Vector2d size_mm{1, 1};
  Eigen::Vector2d along{1, 0}, across{0, 1};  ///< unit, on the flat sheet: the axis, and 90 degrees left of it
  double curvature = 0;                       ///< 1 / radius, 1 / mm
};

/// `moved_mm` changes the shape a little, as calibrations do: by its first number the sheet's rim (half a diagonal from
/// the middle, across the axis) rises, by its second the axis' end there moves sideways; mm.
Cylinder cylinder_of(const Bend& bend, const Eigen::Vector2d& size_mm,
                     const Eigen::Vector2d& moved_mm = Eigen::Vector2d::Zero());

/// The bend of a cylinder, its axis within 0 .. 180 degrees.
Bend bend_of(const Cylinder& cylinder);

/// A place of a bent sheet. `along` and `across` are the directions in space of the flat sheet's `along` and `across`.
struct BentPlace {
  Eigen::Vector3d position_mm, normal, along, across;
};
BentPlace bent_place(const Cylinder& cylinder, const Eigen::Vector2d& flat_mm);

/// How a place and its normal move with `moved_mm` of cylinder_of().
struct BentMotion {
  Eigen::Vector3d position_by[2], normal_by[2];
};
BentMotion bent_motion(const Cylinder& cylinder, const Eigen::Vector2d& flat_mm);

/// Where a ray first meets the sheet, if that is its face; nothing where it passes, or meets the sheet's back first.
std::optional<Eigen::Vector2d> flat_place(const Cylinder& cylinder, const Eigen::Vector3d& origin_mm,
                                          const Eigen::Vector3d& direction);

/// Whether the way from a place of the face to `from_mm` is blocked by the sheet itself, or leads behind it.
bool hidden_from(const Cylinder& cylinder, const BentPlace& place, const Eigen::Vector3d& from_mm);

/// The least radius that a sheet of that size can be bent to about that axis before its edges meet behind it, mm.
double least_radius_mm(const Eigen::Vector2d& size_mm, double axis_deg);

/// What is wrong with a bend, as the end of a sentence that names its field ("is 12, but ..."), and what to do; nothing
/// where it is lawful.
struct BendFault {
  std::string field, what, remedy;
};
std::optional<BendFault> fault_of(const Bend& bend, const Eigen::Vector2d& size_mm);

}  // namespace burin
