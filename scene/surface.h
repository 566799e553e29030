// burin/scene/surface.h - a face that is flat, slightly bowed, or bent to a cylinder.
// Frame: board, mm. docs/model.md 1.2 and 1.3. burin/scene/board_mesh.h has meshes with uv; burin/scene/board_face.h
// combines all kinds of face.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "burin/scene/bend.h"

namespace burin {

/// The face's height z = b0 X^2 + b1 X Y + b2 Y^2; X and Y run from -1 to 1 over the board. On a bent sheet the first
/// two numbers of the bow change its cylinder instead (see cylinder_of()); the third has no effect.
struct Surface {
  Eigen::Vector2d size_mm{1, 1};
  Eigen::Vector3d bow_mm{0, 0, 0};
  std::optional<Bend> bend{};
};

/// For a bent sheet.
inline Cylinder cylinder_of(const Surface& s) { return cylinder_of(*s.bend, s.size_mm, s.bow_mm.head<2>()); }

/// For a face without a bend.
inline double height_mm(const Surface& s, double x_mm, double y_mm) {
  const double X = 2 * x_mm / s.size_mm.x() - 1, Y = 2 * y_mm / s.size_mm.y() - 1;
  return s.bow_mm[0] * X * X + s.bow_mm[1] * X * Y + s.bow_mm[2] * Y * Y;
}

/// Position in space of a flat place.
inline Eigen::Vector3d face_point(const Surface& s, double x_mm, double y_mm) {
  if (s.bend) return bent_place(cylinder_of(s), {x_mm, y_mm}).position_mm;
  return {x_mm, y_mm, height_mm(s, x_mm, y_mm)};
}

/// Unit normal of the face, out of the metal, at a flat place.
inline Eigen::Vector3d face_normal(const Surface& s, double x_mm, double y_mm) {
  if (s.bend) return bent_place(cylinder_of(s), {x_mm, y_mm}).normal;
  const double X = 2 * x_mm / s.size_mm.x() - 1, Y = 2 * y_mm / s.size_mm.y() - 1;
  const double dz_dx = (2 * s.bow_mm[0] * X + s.bow_mm[1] * Y) * 2 / s.size_mm.x();
  const double dz_dy = (s.bow_mm[1] * X + 2 * s.bow_mm[2] * Y) * 2 / s.size_mm.y();
  return Eigen::Vector3d(-dz_dx, -dz_dy, 1).normalized();
}

/// The rotation that takes the face's normal to z by the shortest way. In its target frame (`face`), grooves have the
/// same directions as on a flat board. A scratch's direction in board xy is therefore valid on a bowed or bent face too
/// (docs/model.md 1.1).
inline Eigen::Matrix3d R_face_board(const Eigen::Vector3d& normal) {
  const Eigen::Vector3d m = normal + Eigen::Vector3d::UnitZ();
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity() - m * m.transpose() / (1 + normal.z());
  R.row(2) += 2 * normal.transpose();
  return R;
}

/// A point `z_mm` above the face: a tag's paper. The offset is along the normal of a bent sheet, otherwise along z.
inline Eigen::Vector3d above_face(const Surface& s, double x_mm, double y_mm, double z_mm) {
  if (s.bend) {
    const BentPlace place = bent_place(cylinder_of(s), {x_mm, y_mm});
    return place.position_mm + z_mm * place.normal;
  }
  return {x_mm, y_mm, height_mm(s, x_mm, y_mm) + z_mm};
}

}  // namespace burin
