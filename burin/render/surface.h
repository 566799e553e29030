// burin/render/surface.h - the face of the board as it lies: flat, or bowed a little. Frame: board,
// mm. docs/model.md 1.2. A mesh with uv is burin/render/board_mesh.h.
#pragma once

#include <Eigen/Core>

namespace burin {

/// The face's height z = b0 X^2 + b1 X Y + b2 Y^2, X and Y running from -1 to 1 over the board.
struct Surface {
  Eigen::Vector2d size_mm{1, 1};
  Eigen::Vector3d bow_mm{0, 0, 0};
};

inline double height_mm(const Surface& s, double x_mm, double y_mm) {
  const double X = 2 * x_mm / s.size_mm.x() - 1, Y = 2 * y_mm / s.size_mm.y() - 1;
  return s.bow_mm[0] * X * X + s.bow_mm[1] * X * Y + s.bow_mm[2] * Y * Y;
}

/// Unit normal of the face, out of the metal.
inline Eigen::Vector3d face_normal(const Surface& s, double x_mm, double y_mm) {
  const double X = 2 * x_mm / s.size_mm.x() - 1, Y = 2 * y_mm / s.size_mm.y() - 1;
  const double dz_dx = (2 * s.bow_mm[0] * X + s.bow_mm[1] * Y) * 2 / s.size_mm.x();
  const double dz_dy = (s.bow_mm[1] * X + 2 * s.bow_mm[2] * Y) * 2 / s.size_mm.y();
  return Eigen::Vector3d(-dz_dx, -dz_dy, 1).normalized();
}

}  // namespace burin
