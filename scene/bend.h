// burin/scene/bend.h - a sheet that is bent to a cylinder after carving. docs/model.md 1.3.
//
// A flat place is a position on the flat sheet, mm, as in scratches.csv and board.json. Bending keeps lengths on the
// sheet, so each point of the metal keeps its flat place.
// Frame: board, mm; the sheet's middle keeps its place and normal. The face is the part of the front that is visible
// from +z.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

namespace burin {

/// Radius and axis of a bend.
struct Bend {
  double radius_mm = 0;  ///< of the face; above 0: convex towards the viewer, below 0: concave; never 0
  double axis_deg = 0;   ///< the cylinder's direction on the board, from +x counter-clockwise; modulo 180
};

/// A bent sheet with precomputed directions.
struct Cylinder {
  Eigen::Vector2d size_mm{1, 1};
  Eigen::Vector2d along{1, 0}, across{0, 1};  ///< unit, on the flat sheet: the axis, and 90 degrees left of it
  double curvature = 0;                       ///< 1 / radius, 1 / mm
};

/// `moved_mm` changes the shape slightly, as calibrations do. Its first number raises the sheet's rim (half a diagonal
/// from the middle, across the axis), mm. Its second number moves the axis' end there sideways, mm.
Cylinder cylinder_of(const Bend& bend, const Eigen::Vector2d& size_mm,
                     const Eigen::Vector2d& moved_mm = Eigen::Vector2d::Zero());

/// The bend of a cylinder, its axis within 0 .. 180 degrees.
Bend bend_of(const Cylinder& cylinder);

/// A point of a bent sheet. `along` and `across` are the directions in space of the flat sheet's `along` and `across`.
struct BentPlace {
  Eigen::Vector3d position_mm, normal, along, across;
};
BentPlace bent_place(const Cylinder& cylinder, const Eigen::Vector2d& flat_mm);

/// Derivatives of a position and its normal by the two numbers of cylinder_of()'s `moved_mm`.
struct BentMotion {
  Eigen::Vector3d position_by[2], normal_by[2];
};
BentMotion bent_motion(const Cylinder& cylinder, const Eigen::Vector2d& flat_mm);

/// First intersection of a ray with the face; nothing if the ray misses the sheet or meets its back first.
std::optional<Eigen::Vector2d> flat_place(const Cylinder& cylinder, const Eigen::Vector3d& origin_mm,
                                          const Eigen::Vector3d& direction);

/// True if the sheet itself blocks the segment from a place of the face to `from_mm`, or the segment leads behind it.
bool hidden_from(const Cylinder& cylinder, const BentPlace& place, const Eigen::Vector3d& from_mm);

/// The least radius of a sheet of that size about that axis before its edges meet behind it, mm.
double least_radius_mm(const Eigen::Vector2d& size_mm, double axis_deg);

/// An invalid field of a bend, its fault as the end of a sentence ("is 12, but ..."), and the remedy. fault_of()
/// returns nothing for a valid bend.
struct BendFault {
  std::string field, what, remedy;
};
std::optional<BendFault> fault_of(const Bend& bend, const Eigen::Vector2d& size_mm);

}  // namespace burin
