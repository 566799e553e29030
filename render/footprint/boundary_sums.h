// burin/render/footprint/boundary_sums.h - the integral of burin/render/footprint/footprint_integral.h along the
// footprint's boundary, as sums of footprint_core.h's moments. docs/model.md 4.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "burin/render/footprint/footprint_core.h"
#include "burin/render/footprint/footprint_types.h"
#include "burin/scene/groove.h"

namespace burin::footprint {

/// The footprint and the scratch's ends in units of wt/2, with y relative to `y_ref_mm`. This level lies inside the
/// scratch and near the pixel, so small pixels on long scratches keep their digits.
struct ScaledFootprint {
  std::array<double, 4> t, Y;
  double first_end, second_end;
  double sign;  // -1 for counter-clockwise corners: the boundary integral of Y dt is then minus the area
  bool outside;
};

inline ScaledFootprint scale_footprint(const GrooveSegment& groove, const Quad& corners_mm, double rim) {
  // Coordinates beyond this count as infinite. The clamp keeps their products finite.
  constexpr double kFar = 1e60;
  const double scale = 2000 / groove.width_um;
  const auto scaled = [&](double mm) { return std::clamp(mm * scale, -kFar, kFar); };
  double y_mean_mm = 0;
  for (const auto& c : corners_mm) y_mean_mm += c.y() / 4;
  const double y_ref_mm = std::clamp(y_mean_mm, 0.0, groove.length_mm);
  ScaledFootprint f;
  std::array<double, 4>&t = f.t, &Y = f.Y;
  for (int i = 0; i < 4; ++i) {
    t[i] = scaled(corners_mm[i].x());
    Y[i] = scaled(corners_mm[i].y() - y_ref_mm);
  }
  f.first_end = scaled(-y_ref_mm);
  f.second_end = scaled(groove.length_mm - y_ref_mm);
  const double cross = (t[2] - t[0]) * (Y[3] - Y[1]) - (t[3] - t[1]) * (Y[2] - Y[0]);
  f.sign = cross < 0 ? 1 : -1;
  const auto [t_min, t_max] = std::minmax_element(t.begin(), t.end());
  const auto [Y_min, Y_max] = std::minmax_element(Y.begin(), Y.end());
  f.outside = *t_min >= rim || *t_max <= -rim || *Y_min >= f.second_end || *Y_max <= f.first_end;
  return f;
}

/// The boundary integral of clamp(Y, first_end, second_end) W dt for t in `limits`, and its derivatives.
struct BoundarySums {
  double value = 0, turn = 0, radial_over_r2 = 0;
  std::array<double, 4> d_t{}, d_Y{};
  double d_first_end = 0, d_second_end = 0;
  // Signed length of the footprint along the scratch at t = lo, hi. Times W it is the derivative by hi, and minus the
  // derivative by lo.
  double extent_lo = 0, extent_hi = 0;
};

/// `mean_moments(t1, t2)` returns footprint::MomentDerivatives of the weight, as means (see footprint_core.h).
template <class MeanMoments>
BoundarySums boundary_sums(const ScaledFootprint& f, const Limits<double>& limits, const MeanMoments& mean_moments) {
  BoundarySums sums;
  if (!(limits.lo < limits.hi)) return sums;
  for (int i = 0; i < 4; ++i) {
    const int j = (i + 1) % 4;
    const double t1 = f.t[i], t2 = f.t[j], Y1 = f.Y[i], Y2 = f.Y[j], dt = t2 - t1, dY = Y2 - Y1;
    const auto clamped = [&](double Y) { return std::clamp(Y, f.first_end, f.second_end); };
    const auto place_of_t = [&](double t) { return std::clamp((t - t1) / dt, 0.0, 1.0); };
    if ((t1 < limits.hi) != (t2 < limits.hi)) {
      sums.extent_hi += std::copysign(1.0, dt) * clamped(Y1 + place_of_t(limits.hi) * dY);
    }
    if ((t1 < limits.lo) != (t2 < limits.lo)) {
      sums.extent_lo += std::copysign(1.0, dt) * clamped(Y1 + place_of_t(limits.lo) * dY);
    }

    // Parameter along the edge: 0 at its first corner, 1 at its second. The part within the limits of t:
    const double t_min = std::max(std::min(t1, t2), limits.lo), t_max = std::min(std::max(t1, t2), limits.hi);
    if (t_min > t_max) continue;
    double from = 0, to = 1;
    if (dt != 0) {
      from = place_of_t(dt > 0 ? t_min : t_max);
      to = place_of_t(dt > 0 ? t_max : t_min);
    }
    // Cut where Y equals a scratch end: at most three pieces, each below, within or above the ends.
    std::array<double, 4> cuts{from, from, to, to};
    if (dY != 0) {
      const double a = (f.first_end - Y1) / dY, b = (f.second_end - Y1) / dY;
      cuts[1] = std::clamp(std::min(a, b), from, to);
      cuts[2] = std::clamp(std::max(a, b), from, to);
    }
    for (int piece = 0; piece < 3; ++piece) {
      const double length = cuts[piece + 1] - cuts[piece];
      if (!(length > 0)) continue;
      const double middle = 0.5 * (cuts[piece] + cuts[piece + 1]);
      double ta = std::clamp(t1 + cuts[piece] * dt, t_min, t_max),
             tb = std::clamp(t1 + cuts[piece + 1] * dt, t_min, t_max);
      const double forward = ta <= tb ? 1.0 : -1.0;
      if (ta > tb) std::swap(ta, tb);
      MomentDerivatives<double> m = mean_moments(ta, tb);
      const double m1 = forward * m.value.m1;
      const double Y = Y1 + middle * dY;
      const double along = dt * length;
      if (Y > f.first_end && Y < f.second_end) {
        const double half_rise = 0.5 * length * dY;
        sums.value += along * (Y * m.value.m0 + half_rise * m1);
        sums.turn += along * (Y * m.turn.m0 + half_rise * forward * m.turn.m1);
        sums.radial_over_r2 += along * (Y * m.radial_over_r2.m0 + half_rise * forward * m.radial_over_r2.m1);
        const double to_second = length * (middle * m.value.m0 + 0.5 * length * m1);
        const double to_first = length * ((1 - middle) * m.value.m0 - 0.5 * length * m1);
        sums.d_Y[i] += dt * to_first;
        sums.d_Y[j] += dt * to_second;
        sums.d_t[i] -= dY * to_first;
        sums.d_t[j] -= dY * to_second;
      } else {
        const bool below = Y <= f.first_end;
        const double end = below ? f.first_end : f.second_end;
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

/// All sums for one weight; kDerivatives also computes turn and radial.
template <bool kDerivatives>
BoundarySums ndf_sums(const ScaledFootprint& f, const Lobes<double>& lobes, const Limits<double>& limits) {
  return boundary_sums(f, limits, [&](double t1, double t2) {
    if constexpr (kDerivatives) return mean_moments_with_derivatives(lobes, t1, t2);
    return MomentDerivatives<double>{mean_moments(lobes, t1, t2), {}, {}};
  });
}

inline BoundarySums area_sums(const ScaledFootprint& f, double rim) {
  return boundary_sums(f, Limits<double>{-rim, rim}, [](double, double) {
    return MomentDerivatives<double>{{1.0, 0.0}, {}, {}};
  });
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
