// burin/calib/photo/stray_light.h - an unmodeled lamp or window in addition to every photo's lamp, as unknowns of a
// fit. Frame: board, mm. docs/model.md 9, "Effects".
//
// Photos are nearly linear in its numbers, from a window's distance on. They are:
//   - its direction from the board's middle (x / z and y / z);
//   - the board's diagonal over its distance;
//   - the irradiance of the middle (radiant intensity over the square of the distance);
//   - the square of its radius over its distance, as a disk facing the middle.
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

/// True if a light of these numbers (as StrayNumbers) shines along the face, lower than the searched directions. Fits
/// represent light without a lamp in this way.
inline bool grazes(const double* numbers) {
  constexpr double kSteepest = 5.67;  // tan 80 degrees
  return std::hypot(numbers[kStraySlopeX], numbers[kStraySlopeY]) > kSteepest;
}

/// True if there is one.
inline bool has_stray(const Unknowns& x) { return x[unknown::stray_light] > 0; }

/// The lamp of these numbers; its id is "stray".
Light stray_light(const StrayNumbers& numbers, const Eigen::Vector2d& board_size_mm);
Light stray_light(const Unknowns& x, const Eigen::Vector2d& board_size_mm);

/// The numbers of a lamp.
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
