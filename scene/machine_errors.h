// burin/scene/machine_errors.h - machine errors in addition to the affine machine calibration: backlash, and screws
// with uneven pitch.
// Frame: board, mm. docs/model.md 7.9.
//
// A commanded position p becomes, axis by axis and before the affine map,
//   p + a sin(2 pi p / period) + b cos(2 pi p / period) - backlash / 2 sign(way).
#pragma once

#include <Eigen/Core>
#include <optional>

namespace burin {

/// Backlash and periodic error of the screws, for x and y.
struct MachineErrors {
  Eigen::Vector2d backlash_mm{0, 0};
  Eigen::Vector2d screw_sin_mm{0, 0}, screw_cos_mm{0, 0};  ///< a and b
  Eigen::Vector2d screw_period_mm{5, 5};
  std::optional<Eigen::Vector2d> backlash_sigma_mm;
  std::optional<Eigen::Vector2d> screw_sigma_mm;  ///< of the amplitudes

  /// True if the affine map is the whole error.
  bool none() const { return backlash_mm.isZero(0) && !uneven(); }
  /// True if uneven screws bend the grooves.
  bool uneven() const { return !screw_sin_mm.isZero(0) || !screw_cos_mm.isZero(0); }
  /// Amplitudes of the screws' errors, mm, and their phases, degrees: amplitude sin(2 pi p / period + phase).
  Eigen::Vector2d screw_mm() const;
  /// Phases of the screw errors in x and y, degrees.
  Eigen::Vector2d screw_phase_deg() const;
};

/// Position of a commanded place before the affine map, for a tool that moves along `way`.
Eigen::Vector2d displaced(const MachineErrors& errors, const Eigen::Vector2d& told_mm, const Eigen::Vector2d& way);

/// The commanded position that ends at `wanted_mm`: the inverse of displaced().
Eigen::Vector2d told_for(const MachineErrors& errors, const Eigen::Vector2d& wanted_mm, const Eigen::Vector2d& way);

/// Number of straight pieces of a commanded line, eight per period of the shorter screw. Each piece then differs from
/// the carved curve by less than a tenth of the screws' error, and by less than a fifth of its greatest slope.
int pieces_for(const MachineErrors& errors, const Eigen::Vector2d& from_mm, const Eigen::Vector2d& to_mm);

}  // namespace burin
