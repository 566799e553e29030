// burin/scene/machine_errors.h - what a machine does beside its affine map: backlash, and screws whose pitch is
// uneven. Frame: board, mm. docs/model.md 7.9.
//
// A place p that the machine is told becomes, axis by axis and before its affine map,
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

  /// Whether the affine map says all.
  bool none() const { return backlash_mm.isZero(0) && !uneven(); }
  /// Whether grooves bend.
  bool uneven() const { return !screw_sin_mm.isZero(0) || !screw_cos_mm.isZero(0); }
  /// Amplitudes of the screws' errors, mm, and their phases, degrees: amplitude sin(2 pi p / period + phase).
  Eigen::Vector2d screw_mm() const;
  Eigen::Vector2d screw_phase_deg() const;
};

/// Where a told place comes to lie before the affine map, the tool moving along `way`.
Eigen::Vector2d displaced(const MachineErrors& errors, const Eigen::Vector2d& told_mm, const Eigen::Vector2d& way);

/// The place to tell so that it comes to lie at `wanted_mm`: the inverse of displaced().
Eigen::Vector2d told_for(const MachineErrors& errors, const Eigen::Vector2d& wanted_mm, const Eigen::Vector2d& way);

/// Into how many straight pieces a told line must be cut so that each differs from the carved curve by less than a
/// tenth of the screws' error and by a fifth of its greatest slope: eight a period of the shorter screw.
int pieces_for(const MachineErrors& errors, const Eigen::Vector2d& from_mm, const Eigen::Vector2d& to_mm);

}  // namespace burin
