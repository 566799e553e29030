// burin/scene/groove.h - the cross-section of one scratch.
// Frame: scratch (y along it, x across it, z out of the metal). Units: um. docs/model.md 2.1 to 2.4.
// Source: Shen et al., ACM TOG 42(4) 2023, Eqn. 2. width_um is the paper's w-tilde, depth_um its d.
#pragma once

#include <cmath>

namespace burin {

/// T = 2 w / wt = sqrt(1 - exp(-2 d / wt)), the groove edge (rim) in units of half the width. w is the half-width at
/// which the wall meets the face. 2 atan(T) is the groove's steepest slope. Templated: double, float, Ceres Jets.
template <typename T>
T groove_rim(const T& width_um, const T& depth_um) {
  using std::expm1;
  using std::sqrt;
  return sqrt(-expm1(T(-2) * depth_um / width_um));
}

/// Half-width w at which the wall meets the face: height(w) = 0 in Eqn. 2 (supplement, Eqn. 2), solved in closed form,
///   w = (wt / 2) sqrt(1 - exp(-2 d / wt)).
template <typename T>
T half_width_um(const T& width_um, const T& depth_um) {
  return width_um / T(2) * groove_rim(width_um, depth_um);
}

/// Height of the groove's bottom at x across it, below 0 inside |x| < w (Eqn. 2). Defined for |x| < width_um / 2.
template <typename T>
T groove_height_um(const T& x_um, const T& width_um, const T& depth_um) {
  using std::log1p;
  const T t = T(2) * x_um / width_um;
  return -width_um / T(2) * log1p(-t * t) - depth_um;
}

}  // namespace burin
