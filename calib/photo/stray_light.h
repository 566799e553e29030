// burin/calib/photo/stray_light.h - a lamp or window that shines beside every photo's lamp and that nobody named, as
// unknowns of a fit. Frame: board, mm. docs/model.md 9, "Effects".
//
// Its numbers are those that photos follow nearly linearly from as far away as a window: where it is seen from the
// board's middle (x / z and y / z), the board's diagonal over its distance, what irradiates the middle (radiant
// intensity over the square of the distance), and the square of its radius over its distance, as a disk that faces the
// middle.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "burin/calib/photo/unknowns.h"
#include "burin/scene/light.h"

namespace burin {

/// Its numbers, in the order of the table of unknowns.
enum StrayNumber : std::uint8_t {
  kStraySlopeX,
  kStraySlopeY,
  kStrayNearness,
  kStrayIrradiance,
  kStraySpread2,
  kStrayNumbers
};
using StrayNumbers = std::array<double, kStrayNumbers>;

/// Whether a light by its numbers (as StrayNumbers) shines along the face, from lower than places are sought at: what a
/// fit makes of light that comes from no lamp.
inline bool grazes(const double* numbers) {
  constexpr double kSteepest = 5.67;  // tan 80 degrees
  return std::hypot(numbers[kStraySlopeX], numbers[kStraySlopeY]) > kSteepest;
}

/// Whether there is one.
inline bool has_stray(const Unknowns& x) { return x[unknown::stray_light] > 0; }

/// The lamp that these numbers make; its id is "stray".
Light stray_light(const StrayNumbers& numbers, const Eigen::Vector2d& board_size_mm);
Light stray_light(const Unknowns& x, const Eigen::Vector2d& board_size_mm);

/// And back.
StrayNumbers stray_numbers(const Light& light, const Eigen::Vector2d& board_size_mm);

/// Its numbers among others, of which `first` is unknown::stray's.
inline StrayNumbers stray_numbers(const double* first) {
  StrayNumbers out;
  std::copy_n(first, kStrayNumbers, out.begin());
  return out;
}

/// Derivatives of its position (mm) and of the logarithm of its intensity by the numbers.
Eigen::Matrix<double, 4, kStrayNumbers> stray_slopes(const StrayNumbers& numbers, const Eigen::Vector2d& board_size_mm);

}  // namespace burin
