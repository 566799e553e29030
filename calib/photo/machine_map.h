// burin/calib/photo/machine_map.h - the affine machine calibration in fits: about the carve area's center, so that
// linear part and shift are nearly uncorrelated. carved = center + A (designed - center) + shift, mm. docs/model.md 7.
#pragma once

#include <Eigen/Core>

#include "burin/calib/photo/unknowns.h"
#include "burin/scene/bench.h"

namespace burin {

struct MachineMap {
  Eigen::Matrix2d A = Eigen::Matrix2d::Identity();
  Eigen::Vector2d shift_mm{0, 0};
};

/// Index of its numbers among the unknowns: row 0 or 1 (x, y), column 0 or 1 of A, or 2 for the shift.
constexpr int machine_index(int row, int column) {
  return unknown::machine + (column < 2 ? 2 * row + column : 4 + row);
}

/// The map in a vector of unknowns (Unknowns, or the shared ones of all photos).
template <typename Vector>
MachineMap machine_map(const Vector& x) {
  MachineMap map;
  for (int row = 0; row < 2; ++row) {
    for (int column = 0; column < 2; ++column) map.A(row, column) = x[machine_index(row, column)];
    map.shift_mm[row] = x[machine_index(row, 2)];
  }
  return map;
}

/// Writes it there.
template <typename Vector>
void put_machine_map(const MachineMap& map, Vector&& x) {
  for (int row = 0; row < 2; ++row) {
    for (int column = 0; column < 2; ++column) x[machine_index(row, column)] = map.A(row, column);
    x[machine_index(row, 2)] = map.shift_mm[row];
  }
}

/// Conversions from and to a bench's map, which is about the board's origin.
inline MachineMap machine_map(const Affine2& affine, const Eigen::Vector2d& center_mm) {
  return {affine.leftCols<2>(), affine.leftCols<2>() * center_mm + affine.col(2) - center_mm};
}
inline Affine2 affine_of(const MachineMap& map, const Eigen::Vector2d& center_mm) {
  Affine2 affine;
  affine << map.A, center_mm - map.A * center_mm + map.shift_mm;
  return affine;
}

/// The derivative by n unknowns of coordinate `row` of a carved point: a(0), a(1) from the center (mm), a(2) times the
/// shift.
inline Eigen::VectorXd machine_combination(Eigen::Index n, int row, const Eigen::Vector3d& a) {
  Eigen::VectorXd out = Eigen::VectorXd::Zero(n);
  for (int column = 0; column < 3; ++column) out[machine_index(row, column)] = a[column];
  return out;
}

}  // namespace burin
