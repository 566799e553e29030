#include "burin/render/footprint/footprint_integral.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "burin/render/footprint/boundary_sums.h"

namespace burin {
namespace {

using namespace footprint;

// Derivatives by corners, length, depth and width, from those by t, Y, the ends and the rim. Both integrals share them.
struct SharedGradient {
  std::array<Eigen::Vector2d, 4> corner;
  double length_mm, depth_um, width_um;
};

SharedGradient shared_gradient(const GrooveSegment& groove, const ScaledFootprint& f, const BoundarySums& sums,
                               double d_rim, double rim, double factor) {
  SharedGradient g;
  const double per_mm = factor * 2000 / groove.width_um;
  // A larger width increases the unit wt/2, so all coordinates in it shrink. The rim moves as well.
  double shrink = f.first_end * sums.d_first_end + f.second_end * sums.d_second_end;
  for (int i = 0; i < 4; ++i) {
    g.corner[i] = per_mm * Eigen::Vector2d(sums.d_t[i], sums.d_Y[i]);
    shrink += f.t[i] * sums.d_t[i] + f.Y[i] * sums.d_Y[i];
  }
  g.length_mm = per_mm * sums.d_second_end;
  const double drim_ddepth = std::exp(-2 * groove.depth_um / groove.width_um) / (groove.width_um * rim);
  g.depth_um = factor * d_rim * drim_ddepth;
  g.width_um = (factor * (2 * sums.value - shrink) - g.depth_um * groove.depth_um) / groove.width_um;
  return g;
}

}  // namespace

FootprintValue footprint_integral(const GrooveSegment& groove, const Quad& corners_mm,
                                  const Eigen::Vector3d& h_scratch) {
  FootprintValue result;
  if (is_empty(groove)) return result;
  const double rim = groove_rim(groove.width_um, groove.depth_um);
  const auto f = scale_footprint(groove, corners_mm, rim);
  if (f.outside) return result;
  const double unit_mm2 = f.sign * std::pow(groove.width_um / 2000, 2);
  result.area_mm2 = std::max(0.0, unit_mm2 * area_sums(f, rim).value);
  const auto [h, dark] = unit_half(h_scratch);
  if (dark) return result;
  const double alpha = std::min(groove.alpha, 1.0);
  const auto lobes = make_lobes(h.x(), h.y(), h.z(), alpha);
  const auto sums = ndf_sums<false>(f, lobes, front_facing(h.x(), h.z(), rim));
  result.Dhat_mm2 = std::max(0.0, unit_mm2 * alpha * alpha / std::numbers::pi * sums.value);
  return result;
}

FootprintGradient footprint_integral_gradient(const GrooveSegment& groove, const Quad& corners_mm,
                                              const Eigen::Vector3d& h_scratch) {
  FootprintGradient result;
  result.dDhat_dcorner.fill(Eigen::Vector2d::Zero());
  result.darea_dcorner.fill(Eigen::Vector2d::Zero());
  if (is_empty(groove)) return result;
  const double rim = groove_rim(groove.width_um, groove.depth_um);
  const auto f = scale_footprint(groove, corners_mm, rim);
  if (f.outside) return result;
  const double unit_mm2 = f.sign * std::pow(groove.width_um / 2000, 2);

  const auto area = area_sums(f, rim);
  result.value.area_mm2 = std::max(0.0, unit_mm2 * area.value);
  const auto ga = shared_gradient(groove, f, area, area.extent_hi + area.extent_lo, rim, unit_mm2);
  result.darea_dcorner = ga.corner;
  result.darea_dlength_mm = ga.length_mm;
  result.darea_ddepth_um = ga.depth_um;
  result.darea_dwidth_um = ga.width_um;

  const auto [h, dark] = unit_half(h_scratch);
  if (dark) return result;
  const double alpha = std::min(groove.alpha, 1.0);
  const auto lobes = make_lobes(h.x(), h.y(), h.z(), alpha);
  const auto limits = front_facing(h.x(), h.z(), rim);
  if (!(limits.lo < limits.hi)) return result;
  const auto sums = ndf_sums<true>(f, lobes, limits);
  const double factor = unit_mm2 * alpha * alpha / std::numbers::pi;
  result.value.Dhat_mm2 = std::max(0.0, factor * sums.value);

  // Each limit is the rim or, if n.h < 0 there, the root of n.h = 0.
  const bool cut_hi = limits.hi<rim, cut_lo = limits.lo> - rim;
  const double by_hi = sums.extent_hi * weight(lobes, limits.hi);
  const double by_lo = -sums.extent_lo * weight(lobes, limits.lo);
  const auto gd = shared_gradient(groove, f, sums, (cut_hi ? 0 : by_hi) - (cut_lo ? 0 : by_lo), rim, factor);
  result.dDhat_dcorner = gd.corner;
  result.dDhat_dlength_mm = gd.length_mm;
  result.dDhat_ddepth_um = gd.depth_um;
  result.dDhat_dwidth_um = gd.width_um;
  result.dDhat_dalpha = unit_mm2 * alpha / std::numbers::pi * (2 * sums.value - alpha * alpha * sums.radial_over_r2);

  const double H2 = lobes.H2, H = std::sqrt(H2), radial = lobes.r2 * sums.radial_over_r2;
  Eigen::Vector2d d_xz(h.x() * radial + h.z() * sums.turn, h.z() * radial - h.x() * sums.turn);
  d_xz /= H2;
  // The cut itself moves. F = -2 t hx + (1 - t^2) hz = 0 there, and dF/dt = -2H at the right cut, 2H at the left one.
  const auto cut_by_h = [&](double t) -> Eigen::Vector2d { return Eigen::Vector2d(-t, (1 - t * t) / 2) / H; };
  if (cut_hi) d_xz += by_hi * cut_by_h(limits.hi);
  if (cut_lo) d_xz -= by_lo * cut_by_h(limits.lo);
  result.dDhat_dhalf = factor * Eigen::Vector3d(d_xz.x(), 0, d_xz.y());
  return result;
}

}  // namespace burin
