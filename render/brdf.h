// burin/render/brdf.h - factors of the scratch BRDF around the footprint integral, and the lamp. docs/model.md 3 and 5.
// Directions are unit vectors in the board frame and point away from the face. Cosines refer to the face's normal. T is
// the scalar: double, float or a Ceres Jet.
#pragma once

#include <cmath>
#include <numbers>

namespace burin {

/// GGX normal distribution D for the cosine between half vector and (groove) normal; 0 if the cosine is not positive.
/// docs/model.md 3.1 (paper, Eqn. 6-7): alpha^2 / (pi ((n.h)^2 (alpha^2 - 1) + 1)^2). The supplement's Eqn. 6 prints
/// h_x in place of h_z.
template <typename T>
T ggx_D(const T& cos_nh, const T& alpha) {
  if (!(cos_nh > T(0))) return T(0);
  const T a2 = alpha * alpha;
  const T q = cos_nh * cos_nh * (a2 - T(1)) + T(1);
  return a2 / (T(std::numbers::pi) * q * q);
}

/// Smith's G1(v) = 2 / (1 + sqrt(1 + alpha^2 tan^2 theta)); 0 below the horizon.
template <typename T>
T smith_G1(const T& cos_theta, const T& alpha) {
  using std::sqrt;
  if (!(cos_theta > T(0))) return T(0);
  const T c2 = cos_theta * cos_theta;
  return T(2) / (T(1) + sqrt(T(1) + alpha * alpha * (T(1) - c2) / c2));
}

/// Separable G of the paper's Eqn. 3 (docs/model.md 3.2).
template <typename T>
T smith_G(const T& cos_i, const T& cos_o, const T& alpha) {
  return smith_G1(cos_i, alpha) * smith_G1(cos_o, alpha);
}

/// Schlick's Fresnel term for one channel.
template <typename T>
T schlick_F(const T& cos_ho, const T& f0) {
  const T m = T(1) - cos_ho;
  const T m2 = m * m;
  return f0 + (T(1) - f0) * m2 * m2 * m;
}

}  // namespace burin
