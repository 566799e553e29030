#include "burin/scene/face_grain.h"

namespace burin {
namespace {

// Derivatives of exp(2 sign E) by c and s.
struct GrainSlopes {
  GrainMatrix<double> by_c, by_s;
};
GrainSlopes grain_slopes(const FaceGrain& grain, int sign) {
  const double g2 = grain.c * grain.c + grain.s * grain.s, g = std::sqrt(g2);
  // even = cosh(2g), odd = sinh(2g) / g. Their derivatives by g: even'/g = 2 odd, odd'/g = (2 even - odd) / g^2.
  const double even = std::cosh(2 * g), odd = g2 > 1e-12 ? std::sinh(2 * g) / g : 2 + 4. / 3 * g2;
  const double odd_slope = g2 > 1e-6 ? (2 * even - odd) / g2 : 8. / 3 + 16. / 15 * g2;
  const auto by = [&](double component, double dc, double ds) {
    const double d_even = 2 * odd * component, d_odd = sign * odd_slope * component, o = sign * odd;
    return GrainMatrix<double>{d_even + d_odd * grain.c + o * dc, d_odd * grain.s + o * ds,
                               d_even - d_odd * grain.c - o * dc};
  };
  return {by(grain.c, 1, 0), by(grain.s, 0, 1)};
}

double form(const GrainMatrix<double>& m, const Eigen::Vector3d& v) {
  return m.xx * v.x() * v.x() + 2 * m.xy * v.x() * v.y() + m.yy * v.y() * v.y();
}
Eigen::Vector2d half_slope(const GrainMatrix<double>& m, const Eigen::Vector3d& v) {
  return {m.xx * v.x() + m.xy * v.y(), m.xy * v.x() + m.yy * v.y()};
}

// log G1 with its derivatives.
struct LogG1 {
  double log_value, by_log_alpha, by_c, by_s;
  Eigen::Vector3d by_v;
};
LogG1 log_g1(const Eigen::Vector3d& v, double base_alpha, const FaceGrain& grain, const GrainSlopes& slopes) {
  const GrainMatrix<double> m = grain_matrix(grain.c, grain.s, 1);
  const double scale = base_alpha * base_alpha / (v.z() * v.z()), q = scale * form(m, v), root = std::sqrt(1 + q);
  const double by_q = -0.5 / (root * (1 + root));
  LogG1 out{std::log(2 / (1 + root)), 2 * by_q * q, by_q * scale * form(slopes.by_c, v),
            by_q * scale * form(slopes.by_s, v), Eigen::Vector3d::Zero()};
  out.by_v.head<2>() = by_q * scale * 2 * half_slope(m, v);
  out.by_v.z() = -2 * by_q * q / v.z();
  return out;
}

}  // namespace

GrainedLobe grained_lobe(const Eigen::Vector3d& h, const Eigen::Vector3d& wi, const Eigen::Vector3d& wo,
                         double base_alpha, const FaceGrain& grain) {
  GrainedLobe out;
  if (!(h.z() > 0 && wi.z() > 0 && wo.z() > 0)) return out;
  const GrainMatrix<double> m = grain_matrix(grain.c, grain.s, -1);
  const GrainSlopes inverse_slopes = grain_slopes(grain, -1), slopes = grain_slopes(grain, 1);
  const double a2 = base_alpha * base_alpha, q = form(m, h) + a2 * h.z() * h.z();
  const LogG1 i = log_g1(wi, base_alpha, grain, slopes), o = log_g1(wo, base_alpha, grain, slopes);
  out.value = a2 / (std::numbers::pi * q * q) * std::exp(i.log_value + o.log_value);
  out.by_log_alpha = out.value * (2 - 4 * a2 * h.z() * h.z() / q + i.by_log_alpha + o.by_log_alpha);
  out.by_c = out.value * (-2 * form(inverse_slopes.by_c, h) / q + i.by_c + o.by_c);
  out.by_s = out.value * (-2 * form(inverse_slopes.by_s, h) / q + i.by_s + o.by_s);
  out.by_h.head<2>() = -4 * out.value / q * half_slope(m, h);
  out.by_h.z() = -4 * out.value / q * a2 * h.z();
  out.by_wi = out.value * i.by_v;
  out.by_wo = out.value * o.by_v;
  return out;
}

}  // namespace burin
