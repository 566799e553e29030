// burin/scene/face_grain.h - the direction of a brushed face: a GGX lobe with two roughnesses. docs/model.md 3.8.
// Frame: face (pixel_shading.h), with the board's x and y. Directions are unit vectors away from the face.
//
// The lobe's roughness is a symmetric 2 x 2 matrix, base_alpha^2 exp(2 E) with E = [[c, s], [s, -c]]. It is smooth
// everywhere, including at an isotropic face (c = s = 0), and base_alpha stays the geometric mean of both roughnesses.
// Streaks run at half the angle of (-c, -s): along them the face is smoother.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <numbers>

namespace burin {

/// Anisotropy of the plain face's roughness: (c, s) above. Its length is half the logarithm of the ratio across to
/// along, at twice the angle of the direction across the streaks. Both 0: isotropic.
struct FaceGrain {
  double c = 0, s = 0;

  /// True for an isotropic face.
  bool none() const { return c == 0 && s == 0; }
  /// Ratio of the roughnesses across and along, at least 1.
  double ratio() const { return std::exp(2 * std::hypot(c, s)); }
  /// Direction of the streaks from the board's x, degrees, from -90 to 90.
  double along_deg() const { return std::atan2(-s, -c) / 2 * 180 / std::numbers::pi; }
  /// From the roughnesses along and across, and the streaks' direction.
  static FaceGrain of(double along_deg, double alpha_along, double alpha_across) {
    const double q = std::log(alpha_across / alpha_along) / 2, twice = 2 * along_deg * std::numbers::pi / 180;
    return {-q * std::cos(twice), -q * std::sin(twice)};
  }
};

/// exp(2 sign E) as [[xx, xy], [xy, yy]]: the factor (sign 1) or divisor (sign -1) of base_alpha^2.
template <typename T>
struct GrainMatrix {
  T xx, xy, yy;
};
template <typename T>
GrainMatrix<T> grain_matrix(const T& c, const T& s, int sign) {
  using std::cosh;
  using std::sinh;
  using std::sqrt;
  const T g2 = c * c + s * s;
  T even = T(1), odd = T(2);  // cosh(2 g), sinh(2 g) / g
  if (g2 > T(1e-12)) {
    const T g = sqrt(g2);
    even = cosh(T(2) * g);
    odd = sinh(T(2) * g) / g;
  } else {
    even = T(1) + T(2) * g2;
    odd = T(2) + T(4) / T(3) * g2;
  }
  odd = T(sign) * odd;
  return {even + odd * c, odd * s, even - odd * c};
}

/// D(h) of the lobe (docs/model.md 3.8), for a half vector in the frame of the face with hz > 0; otherwise 0.
template <typename T>
T grained_D(const T& hx, const T& hy, const T& hz, const T& base_alpha, const T& c, const T& s) {
  if (!(hz > T(0))) return T(0);
  const GrainMatrix<T> m = grain_matrix(c, s, -1);
  const T a2 = base_alpha * base_alpha;
  const T q = m.xx * hx * hx + T(2) * m.xy * hx * hy + m.yy * hy * hy + a2 * hz * hz;
  return a2 / (T(std::numbers::pi) * q * q);
}

/// Smith's G1 with the roughness in the viewing direction; 0 below the face.
template <typename T>
T grained_G1(const T& vx, const T& vy, const T& vz, const T& base_alpha, const T& c, const T& s) {
  using std::sqrt;
  if (!(vz > T(0))) return T(0);
  const GrainMatrix<T> m = grain_matrix(c, s, 1);
  const T tan2 = base_alpha * base_alpha * (m.xx * vx * vx + T(2) * m.xy * vx * vy + m.yy * vy * vy) / (vz * vz);
  return T(2) / (T(1) + sqrt(T(1) + tan2));
}

/// D(h) G1(wi) G1(wo) of the plain face with its derivatives; h, wi and wo in the frame of the face, all above it.
struct GrainedLobe {
  double value = 0, by_log_alpha = 0, by_c = 0, by_s = 0;
  Eigen::Vector3d by_h{0, 0, 0}, by_wi{0, 0, 0}, by_wo{0, 0, 0};
};
GrainedLobe grained_lobe(const Eigen::Vector3d& h, const Eigen::Vector3d& wi, const Eigen::Vector3d& wo,
                         double base_alpha, const FaceGrain& grain);

}  // namespace burin
