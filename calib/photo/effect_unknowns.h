// burin/calib/photo/effect_unknowns.h - what only some benches have, as the fits move it: backlash and uneven screws, a
// brushed face, a cross-section that is not the paper's. docs/model.md 2.5, 3.8, 7.9.
#pragma once

#include <algorithm>
#include <cmath>

#include "burin/calib/photo/unknowns.h"
#include "burin/scene/face_grain.h"
#include "burin/scene/groove_profile.h"
#include "burin/scene/machine_errors.h"

namespace burin {

/// The machine's errors that a vector of unknowns holds (Unknowns, or those that all photos share).
template <typename Vector>
MachineErrors machine_errors_of(const Vector& x) {
  MachineErrors errors;
  for (int axis = 0; axis < 2; ++axis) {
    errors.backlash_mm[axis] = x[unknown::backlash + axis];
    errors.screw_sin_mm[axis] = x[unknown::screw + 2 * axis];
    errors.screw_cos_mm[axis] = x[unknown::screw + 2 * axis + 1];
    errors.screw_period_mm[axis] = std::exp(x[unknown::screw_period + axis]);
  }
  return errors;
}

/// The face's grain that it holds.
template <typename Vector>
FaceGrain grain_of(const Vector& x) {
  return {x[unknown::grain], x[unknown::grain + 1]};
}

/// The cross-section that it holds, of the kind that the problem has.
template <typename Vector>
GrooveProfile profile_of(const GrooveProfile& kind, const Vector& x) {
  GrooveProfile p = kind;
  p.flank_deg = x[unknown::flank];
  p.burr_left_um = std::max(0.0, x[unknown::burrs]);
  p.burr_right_um = std::max(0.0, x[unknown::burrs + 1]);
  p.burr_width_um = std::exp(x[unknown::burr_width]);
  p.across = std::exp(x[unknown::log_across]);
  return p;
}

/// Step of the difference that stands for a derivative at `value`: a hundredth or two of a logarithm, a micrometer or
/// two of the machine, a fifth of a degree, two thousandths of a stray light's direction, a twentieth of a micrometer
/// of a burr; a whole one where there is none,
/// since light is not linear in a burr that begins.
constexpr double difference_step(int index, double value) {
  if (index >= unknown::backlash && index < unknown::screw_period) return 0.002;
  if (index >= unknown::screw_period && index < unknown::grain) return 0.001;
  if (index == unknown::size2) return 0.05 + 0.02 * value;
  if (index >= unknown::stray && index < unknown::stray_light) return 0.002;
  if (index == unknown::stray_spread2) return 5e-4 + 0.05 * value;
  if (index == unknown::flank) return 0.2;
  if (index >= unknown::burrs && index < unknown::burr_width) return value < 0.2 ? 1 : 0.05;
  return index == unknown::log_across ? 0.1 : 0.02;
}

}  // namespace burin
