// burin/render/footprint/footprint_value.h - the integral of burin/render/footprint/footprint_integral.h over any
// scalar, as a walk around the footprint's boundary: sums of footprint_core.h's moments. docs/model.md 4.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "burin/render/footprint/footprint_core.h"
#include "burin/render/footprint/footprint_types.h"
#include "burin/render/groove.h"

namespace burin::footprint {

/// The footprint and the scratch's ends in units of wt/2, y measured from `y_ref_mm`: a level inside the scratch and
/// near the pixel, so that small pixels on long scratches keep their digits.
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

/// The boundary integral of clamp(Y, first_end, second_end) W dt for t in `limits`, and its derivatives.
template <class T>
struct BoundarySums {
  T value = 0, turn = 0, radial_over_r2 = 0;
  std::array<T, 4> d_t{}, d_Y{};
  T d_first_end = 0, d_second_end = 0;
  T extent_lo = 0, extent_hi = 0;  // signed length of the footprint along the scratch at t = lo, hi: W times it is the
                                   // derivative by hi, and minus that by lo
};

/// `mean_moments(t1, t2)` gives footprint::MomentDerivatives of the weight, as means (see footprint_core.h).
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

    // Walk along the edge, from 0 at its first corner to 1 at its second. The part within the limits of t:
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

inline bool is_empty(const GrooveSegment& g) {
  return !(g.width_um > 0 && g.depth_um > 0 && g.alpha > 0 && g.length_mm > 0);
}

/// Everything for one weight: kDerivatives also fills turn and radial.
template <bool kDerivatives, class T>
BoundarySums<T> ndf_sums(const ScaledFootprint<T>& f, const Lobes<T>& lobes, const Limits<T>& limits) {
  return boundary_sums(f, limits, [&](T t1, T t2) {
    if constexpr (kDerivatives) return mean_moments_with_derivatives(lobes, t1, t2);
    return MomentDerivatives<T>{mean_moments(lobes, t1, t2), {}, {}};
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

inline UnitHalf unit_half(const Eigen::Vector3d& h_scratch) {
  const Eigen::Vector3d h = h_scratch.stableNormalized();
  return {h, !(std::hypot(h.x(), h.z()) > 1e-150)};
}

}  // namespace burin::footprint
