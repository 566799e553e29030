// burin/calib/photo/effect_unknowns.h - unknowns of effects of only some benches: backlash, lead-screw errors, a
// brushed face, a groove profile other than the paper's. docs/model.md 2.5, 3.8, 7.9.
#pragma once

#include <algorithm>
#include <cmath>

#include "burin/calib/photo/unknowns.h"
#include "burin/scene/face_grain.h"
#include "burin/scene/groove_profile.h"
#include "burin/scene/machine_errors.h"

namespace burin {

/// The machine's errors in a vector of unknowns (Unknowns, or the shared ones of all photos).
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

/// The face's grain in it.
template <typename Vector>
FaceGrain grain_of(const Vector& x) {
  return {x[unknown::grain], x[unknown::grain + 1]};
}

/// The groove profile in it, of the problem's kind.
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

/// Step of the finite difference for a derivative at `value`. For logarithms it is a hundredth or two (a tenth for
/// log_across, a thousandth for a screw's period). For the machine it is two micrometers, for a flank a fifth of a
/// degree, for an unmodeled light's direction two thousandths. For a burr it is a twentieth of a micrometer, but one
/// micrometer near 0, since light is not linear in a beginning burr.
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
