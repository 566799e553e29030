#include "burin/render/footprint/footprint_integral.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "burin/render/brdf.h"
#include "burin/render/footprint/footprint_core.h"
#include "burin/render/groove.h"

namespace burin {
namespace {

using footprint::Limits;
using footprint::Lobes;
using footprint::MomentDerivatives;

// The footprint and the scratch's ends in units of wt/2, y measured from `y_ref_mm`: a level inside the scratch and
// near the pixel, so that small pixels on long scratches keep their digits.
template <class T>
struct ScaledFootprint {
  std::array<T, 4> t, Y;
  T first_end, second_end;
  double sign;  // -1 for counter-clockwise corners: the boundary integral of Y dt is then minus the area
  bool outside;
};

template <class T>
ScaledFootprint<T> scale_footprint(const GrooveSegment& groove, const Quad& corners_mm, double rim) {
  // Coordinates beyond these are as good as at infinity; clamped so that their products stay finite.
  const double far = sizeof(T) == 8 ? 1e60 : 1e12;
  const double scale = 2000 / groove.width_um;
  const auto scaled = [&](double mm) { return std::clamp(mm * scale, -far, far); };
  double y_mean_mm = 0;
  for (const auto& c : corners_mm) y_mean_mm += c.y() / 4;
  const double y_ref_mm = std::clamp(y_mean_mm, 0.0, groove.length_mm);
  ScaledFootprint<T> f;
  std::array<double, 4> t, Y;
  for (int i = 0; i < 4; ++i) {
    t[i] = scaled(corners_mm[i].x());
    Y[i] = scaled(corners_mm[i].y() - y_ref_mm);
    f.t[i] = T(t[i]);
    f.Y[i] = T(Y[i]);
  }
  const double first_end = scaled(-y_ref_mm), second_end = scaled(groove.length_mm - y_ref_mm);
  f.first_end = T(first_end);
  f.second_end = T(second_end);
  const double cross = (t[2] - t[0]) * (Y[3] - Y[1]) - (t[3] - t[1]) * (Y[2] - Y[0]);
  f.sign = cross < 0 ? 1 : -1;
  const auto [t_min, t_max] = std::minmax_element(t.begin(), t.end());
  const auto [Y_min, Y_max] = std::minmax_element(Y.begin(), Y.end());
  f.outside = *t_min >= rim || *t_max <= -rim || *Y_min >= second_end || *Y_max <= first_end;
  return f;
}

// The boundary integral of clamp(Y, first_end, second_end) W dt for t in `limits`, and its derivatives.
template <class T>
struct BoundarySums {
  T value = 0, turn = 0, radial_over_r2 = 0;
  std::array<T, 4> d_t{}, d_Y{};
  T d_first_end = 0, d_second_end = 0;
  T extent_lo = 0, extent_hi = 0;  // signed length of the footprint along the scratch at t = lo, hi: W times it is the
                                   // derivative by hi, and minus that by lo
};

// `mean_moments(t1, t2)` gives footprint::MomentDerivatives of the weight, as means (see footprint_core.h).
template <class T, class MeanMoments>
BoundarySums<T> boundary_sums(const ScaledFootprint<T>& f, const Limits<T>& limits, const MeanMoments& mean_moments) {
  BoundarySums<T> sums;
  if (!(limits.lo < limits.hi)) return sums;
  for (int i = 0; i < 4; ++i) {
    const int j = (i + 1) % 4;
    const T t1 = f.t[i], t2 = f.t[j], Y1 = f.Y[i], Y2 = f.Y[j], dt = t2 - t1, dY = Y2 - Y1;
    const auto clamped = [&](T Y) { return std::clamp(Y, f.first_end, f.second_end); };
    const auto place_of_t = [&](T t) { return std::clamp((t - t1) / dt, T(0), T(1)); };
    if ((t1 < limits.hi) != (t2 < limits.hi)) {
      sums.extent_hi += std::copysign(T(1), dt) * clamped(Y1 + place_of_t(limits.hi) * dY);
    }
    if ((t1 < limits.lo) != (t2 < limits.lo)) {
      sums.extent_lo += std::copysign(T(1), dt) * clamped(Y1 + place_of_t(limits.lo) * dY);
    }

    // The edge is a walk of its place from 0 to 1. What of it lies within the limits of t:
    const T t_min = std::max(std::min(t1, t2), limits.lo), t_max = std::min(std::max(t1, t2), limits.hi);
    if (t_min > t_max) continue;
    T from = 0, to = 1;
    if (dt != 0) {
      from = place_of_t(dt > 0 ? t_min : t_max);
      to = place_of_t(dt > 0 ? t_max : t_min);
    }
    // Cut where Y passes the scratch's ends: at most three pieces, each below, within or above them.
    std::array<T, 4> cuts{from, from, to, to};
    if (dY != 0) {
      const T a = (f.first_end - Y1) / dY, b = (f.second_end - Y1) / dY;
      cuts[1] = std::clamp(std::min(a, b), from, to);
      cuts[2] = std::clamp(std::max(a, b), from, to);
    }
    for (int piece = 0; piece < 3; ++piece) {
      const T length = cuts[piece + 1] - cuts[piece];
      if (!(length > 0)) continue;
      const T middle = T(0.5) * (cuts[piece] + cuts[piece + 1]);
      T ta = std::clamp(t1 + cuts[piece] * dt, t_min, t_max), tb = std::clamp(t1 + cuts[piece + 1] * dt, t_min, t_max);
      const T forward = ta <= tb ? T(1) : T(-1);
      if (ta > tb) std::swap(ta, tb);
      MomentDerivatives<T> m = mean_moments(ta, tb);
      const T m1 = forward * m.value.m1;
      const T Y = Y1 + middle * dY;
      const T along = dt * length;
      if (Y > f.first_end && Y < f.second_end) {
        const T half_rise = T(0.5) * length * dY;
        sums.value += along * (Y * m.value.m0 + half_rise * m1);
        sums.turn += along * (Y * m.turn.m0 + half_rise * forward * m.turn.m1);
        sums.radial_over_r2 += along * (Y * m.radial_over_r2.m0 + half_rise * forward * m.radial_over_r2.m1);
        const T to_second = length * (middle * m.value.m0 + T(0.5) * length * m1);
        const T to_first = length * ((1 - middle) * m.value.m0 - T(0.5) * length * m1);
        sums.d_Y[i] += dt * to_first;
        sums.d_Y[j] += dt * to_second;
        sums.d_t[i] -= dY * to_first;
        sums.d_t[j] -= dY * to_second;
      } else {
        const bool below = Y <= f.first_end;
        const T end = below ? f.first_end : f.second_end;
        sums.value += along * end * m.value.m0;
        sums.turn += along * end * m.turn.m0;
        sums.radial_over_r2 += along * end * m.radial_over_r2.m0;
        (below ? sums.d_first_end : sums.d_second_end) += along * m.value.m0;
      }
    }
  }
  return sums;
}

bool is_empty(const GrooveSegment& g) { return !(g.width_um > 0 && g.depth_um > 0 && g.alpha > 0 && g.length_mm > 0); }

// Everything for one weight: kDerivatives also fills turn and radial.
template <bool kDerivatives, class T>
BoundarySums<T> ndf_sums(const ScaledFootprint<T>& f, const Lobes<T>& lobes, const Limits<T>& limits) {
  return boundary_sums(f, limits, [&](T t1, T t2) {
    if constexpr (kDerivatives) return footprint::mean_moments_with_derivatives(lobes, t1, t2);
    return MomentDerivatives<T>{footprint::mean_moments(lobes, t1, t2), {}, {}};
  });
}

template <class T>
BoundarySums<T> area_sums(const ScaledFootprint<T>& f, T rim) {
  return boundary_sums(f, Limits<T>{-rim, rim}, [](T, T) { return MomentDerivatives<T>{{T(1), T(0)}, {}, {}}; });
}

struct UnitHalf {
  Eigen::Vector3d h;
  bool dark;  // no direction, or n.h = 0 all over the groove
};

UnitHalf unit_half(const Eigen::Vector3d& h_scratch) {
  const Eigen::Vector3d h = h_scratch.stableNormalized();
  return {h, !(std::hypot(h.x(), h.z()) > 1e-150)};
}

template <class T>
FootprintValue value_in(const GrooveSegment& groove, const Quad& corners_mm, const Eigen::Vector3d& h_scratch) {
  FootprintValue result;
  if (is_empty(groove)) return result;
  const double rim = groove_rim(groove.width_um, groove.depth_um);
  const auto f = scale_footprint<T>(groove, corners_mm, rim);
  if (f.outside) return result;
  const double unit_mm2 = f.sign * std::pow(groove.width_um / 2000, 2);
  result.area_mm2 = std::max(0.0, unit_mm2 * double(area_sums(f, T(rim)).value));
  const auto [h, dark] = unit_half(h_scratch);
  if (dark) return result;
  const T alpha = T(std::min(groove.alpha, 1.0));
  const auto lobes = footprint::make_lobes(T(h.x()), T(h.y()), T(h.z()), alpha);
  const auto sums = ndf_sums<false>(f, lobes, footprint::front_facing(T(h.x()), T(h.z()), T(rim)));
  result.Dhat_mm2 = std::max(0.0, unit_mm2 * double(alpha) * double(alpha) / std::numbers::pi * double(sums.value));
  return result;
}

// Derivatives that both integrals share: by corners, length, depth, width, from those by t, Y, the ends and the rim.
struct SharedGradient {
  std::array<Eigen::Vector2d, 4> corner;
  double length_mm, depth_um, width_um;
};

SharedGradient shared_gradient(const GrooveSegment& groove, const ScaledFootprint<double>& f,
                               const BoundarySums<double>& sums, double d_rim, double rim, double factor) {
  SharedGradient g;
  const double per_mm = factor * 2000 / groove.width_um;
  // A wider groove: the unit wt/2 grows, so all coordinates in it shrink, and the rim moves as well.
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
  return value_in<double>(groove, corners_mm, h_scratch);
}

FootprintValue footprint_integral_float(const GrooveSegment& groove, const Quad& corners_mm,
                                        const Eigen::Vector3d& h_scratch) {
  return value_in<float>(groove, corners_mm, h_scratch);
}

FootprintGradient footprint_integral_gradient(const GrooveSegment& groove, const Quad& corners_mm,
                                              const Eigen::Vector3d& h_scratch) {
  FootprintGradient result;
  result.dDhat_dcorner.fill(Eigen::Vector2d::Zero());
  result.darea_dcorner.fill(Eigen::Vector2d::Zero());
  if (is_empty(groove)) return result;
  const double rim = groove_rim(groove.width_um, groove.depth_um);
  const auto f = scale_footprint<double>(groove, corners_mm, rim);
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
  const auto lobes = footprint::make_lobes(h.x(), h.y(), h.z(), alpha);
  const auto limits = footprint::front_facing(h.x(), h.z(), rim);
  if (!(limits.lo < limits.hi)) return result;
  const auto sums = ndf_sums<true>(f, lobes, limits);
  const double factor = unit_mm2 * alpha * alpha / std::numbers::pi;
  result.value.Dhat_mm2 = std::max(0.0, factor * sums.value);

  // Each limit is the rim or, where the groove turns its back to h, the place where n.h = 0.
  const bool cut_hi = limits.hi<rim, cut_lo = limits.lo> - rim;
  const double by_hi = sums.extent_hi * footprint::weight(lobes, limits.hi);
  const double by_lo = -sums.extent_lo * footprint::weight(lobes, limits.lo);
  const auto gd = shared_gradient(groove, f, sums, (cut_hi ? 0 : by_hi) - (cut_lo ? 0 : by_lo), rim, factor);
  result.dDhat_dcorner = gd.corner;
  result.dDhat_dlength_mm = gd.length_mm;
  result.dDhat_ddepth_um = gd.depth_um;
  result.dDhat_dwidth_um = gd.width_um;
  result.dDhat_dalpha = unit_mm2 * alpha / std::numbers::pi * (2 * sums.value - alpha * alpha * sums.radial_over_r2);

  const double H2 = lobes.H2, H = std::sqrt(H2), radial = lobes.r2 * sums.radial_over_r2;
  Eigen::Vector2d d_xz(h.x() * radial + h.z() * sums.turn, h.z() * radial - h.x() * sums.turn);
  d_xz /= H2;
  // The cut itself moves: F = -2 t hx + (1 - t^2) hz = 0 there, and dF/dt = -2H at the right cut, 2H at the left one.
  const auto cut_by_h = [&](double t) -> Eigen::Vector2d { return Eigen::Vector2d(-t, (1 - t * t) / 2) / H; };
  if (cut_hi) d_xz += by_hi * cut_by_h(limits.hi);
  if (cut_lo) d_xz -= by_lo * cut_by_h(limits.lo);
  result.dDhat_dhalf = factor * Eigen::Vector3d(d_xz.x(), 0, d_xz.y());
  return result;
}

}  // namespace burin
