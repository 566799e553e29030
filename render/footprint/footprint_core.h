// burin/render/footprint/footprint_core.h - moments of the groove's NDF over an interval across the groove, in closed
// form, with their derivatives. One implementation serves double, float and SIMD vectors.
//
// Problem. Across a groove (docs/model.md 2) the slope variable t = 2 x / wt runs over [-T, T], T = groove_rim(). The
// normal is n = (-2t, 0, 1 - t^2) / (1 + t^2). In units of wt/2 (t = 2x/wt, Y = 2y/wt, Lam = 2L/wt) the footprint
// integral is a boundary integral (Green),
//   Dhat = (wt/2)^2 (alpha^2 / pi) * closed integral of clamp(Y, 0, Lam) W dt,    W(t) = (1 - r^2 (n.h)^2)^-2,
// with r^2 = 1 - alpha^2, t clamped to [-T, T] and to where n.h > 0. On a piece of an edge where Y is linear in t,
//   integral of Y W dt = Y(tm) m0 + (dY/dt) m1,
//   m0 = integral of W dt,   m1 = integral of (t - tm) W dt,   tm = (t1 + t2) / 2 the middle of the piece.
// moments() returns m0 and m1. moments_with_derivatives() adds their derivatives by h and alpha at fixed t1, t2. The
// closed integral of W alone is zero, so any level may be the origin of Y. A level near the pixel keeps the digits.
//
// Two lobes. Let e = r hx, k = r hz, p = 1 + k, q = 1 - k, H^2 = hx^2 + hz^2, s^2 = hy^2 + alpha^2 H^2 and u = r (n.h).
// s^2 equals p q - e^2, a form that cancels and is never evaluated. Then
//   W = (R1^2 + R1 + R2^2 + R2) / 4,   R1 = 1 / (1 - u) = (1 + t^2) / Q1,   R2 = 1 / (1 + u) = (1 + t^2) / Q2,
//   Q1 = q + 2 e t + p t^2  (the front lobe, the glint's peak),   Q2 = p - 2 e t + q t^2  (the back lobe, smooth).
// The back lobe is the front lobe at (-e, -k), so one implementation is enough. Let tau = p t + e, N = tau^2 + s^2 = p
// Q1:
//   R = 1/p + (g - f tau) / N,   g = 2 (1 - s^2/p),   f = 2 e / p.
// So R^2 + R is c0 + sum over j of (a_j + b_j tau) / N^j, j <= 2, by tau^2 = N - s^2.
//
// Derivatives. Two directions span all changes of h and alpha, and neither cancels. ' is by either, at fixed t:
//   turn:    h turns about the groove's axis, d(hx, hz) = (hz, -hx); s stays. u' = -(2 t k + (1 - t^2) e) / (1 + t^2),
//            R' = R^2 u' = R (e/p - (f s^2 + g tau) / N) for the front lobe, and so for the back lobe at (-e, -k).
//   radial:  (hx, hz) grows; u' = u. R' = R^2 - R for both lobes, so (R^2 + R)' = 2 R^3 - R^2 - R.
// From them, with W as a function of n.h alone (s^2 = p q - e^2):
//   dW/dhx = (hx radial + hz turn) / H^2,   dW/dhz = (hz radial - hx turn) / H^2,   dW/dalpha = -alpha radial / r^2.
// `radial_over_r2` is radial / r^2, which stays finite as alpha -> 1. Here j <= 3.
//
// Integration of each lobe without loss of digits: burin/render/footprint/footprint_lobe.h.
//
// T is double, float or a SIMD vector of floats (xsimd::batch). T needs arithmetic, comparisons with masks as results,
// and sqrt, abs, min, max, log1p, select, found by argument-dependent lookup. Preconditions of all functions: |h| = 1,
// 0 < alpha <= 1, |t| <= 1, t1 <= t2, n.h >= 0 on [t1, t2] (front_facing()). Sources: docs/model.md 4.1 to 4.22; Shen
// et al. 2023, Eqn. 8-10.
#pragma once

#include <cmath>

#include "burin/render/footprint/footprint_lobe.h"

namespace burin::footprint {

/// Quantities of one half vector and roughness for the integrals (see the top comment).
template <class T>
struct Lobes {
  T e, k, p, q, s2, s, inv_s;
  T r, r2;  ///< r2 = 1 - alpha^2
  T H2;     ///< hx^2 + hz^2
  T hx, hz, alpha;
};

/// From a unit half vector in the scratch frame and a roughness, 0 < alpha <= 1.
template <class T>
[[gnu::always_inline]] inline Lobes<T> make_lobes(const T& hx, const T& hy, const T& hz, const T& alpha) {
  using std::abs;
  using std::max;
  using Scalar = typename detail::ScalarOf<T>::Type;
  Lobes<T> l;
  l.hx = hx;
  l.hz = hz;
  l.alpha = alpha;
  l.r2 = (T(1) - alpha) * (T(1) + alpha);
  l.r = l.r2 * Arithmetic<T>::inverse_sqrt(max(l.r2, T(1e-30f)));
  l.H2 = hx * hx + hz * hz;
  l.e = l.r * hx;
  l.k = l.r * hz;
  // Takes effect only below any real alpha (1e-15, or 1e-9 in float): keeps 1/s^5 finite.
  const T least_s2 = T(sizeof(Scalar) == 8 ? Scalar(1e-60) : Scalar(1e-14));
  l.s2 = max(hy * hy + alpha * alpha * l.H2, least_s2);
  l.inv_s = Arithmetic<T>::inverse_sqrt(l.s2);
  l.s = l.s2 * l.inv_s;
  // The smaller of p and q would cancel as 1 - |k|, but their product is e^2 + s^2.
  const T large = T(1) + abs(l.k);
  const T small = (l.e * l.e + l.s2) * Arithmetic<T>::inverse(large);
  const auto up = l.k >= T(0);
  l.p = select(up, large, small);
  l.q = select(up, small, large);
  return l;
}

/// W at one t: D = (alpha^2 / pi) W.
template <class T>
T weight(const Lobes<T>& l, const T& t) {
  const T a = T(1) + t * t;
  const T N1 = detail::square(l.p * t + l.e) + l.s2;
  const T Q1 = select(l.p >= T(0.5), N1 / l.p, l.q + t * (T(2) * l.e + l.p * t));
  const T Q2 = l.p + t * (l.q * t - T(2) * l.e);
  return detail::square(a * a / (Q1 * Q2));
}

/// The part of [-rim, rim] where n.h > 0; `lo` >= `hi` if it is empty. At most one end is cut off, since |t| <= 1: n.h
/// = 0 at t = hz / (hx + H) for hx >= 0 and at t = -hz / (H - hx) otherwise.
template <class T>
struct Limits {
  T lo, hi;
};
template <class T>
Limits<T> front_facing(const T& hx, const T& hz, const T& rim) {
  using std::abs;
  using std::max;
  using std::min;
  const T least(1e-30f), H2 = hx * hx + hz * hz;
  const T H = H2 * Arithmetic<T>::inverse_sqrt(max(H2, least));
  const T reach = hz * Arithmetic<T>::inverse(max(abs(hx) + H, least));
  const T cut = select(H2 > least, reach, T(-2));  // H = 0: n.h is 0 everywhere
  const auto right = hx >= T(0);
  return {select(right, -rim, max(-rim, -cut)), select(right, min(rim, cut), rim)};
}

/// Moments of W, of its derivative by `turn`, and of its derivative by `radial` over r^2.
template <class T>
struct MomentDerivatives {
  Moments<T> value, turn, radial_over_r2;
};

/// One lobe's part, before the division by 4.
template <Parts kWhat, bool kMean, class T>
[[gnu::always_inline]] inline detail::LobeMoments<kWhat, T> front_lobe(const Lobes<T>& l, const T& t1, const T& t2) {
  return detail::lobe<kWhat, kMean, false>(l.p, l.q, l.e, l.k, l.r, l.s2, l.s, l.inv_s, t1, t2);
}
template <Parts kWhat, bool kMean, class T>
[[gnu::always_inline]] inline detail::LobeMoments<kWhat, T> back_lobe(const Lobes<T>& l, const T& t1, const T& t2) {
  return detail::lobe<kWhat, kMean, true>(l.q, l.p, T(-l.e), T(-l.k), T(-l.r), l.s2, l.s, l.inv_s, t1, t2);
}

namespace detail {

// Part i of the result is the sum of part i of both lobes, over 4.
template <Parts kWhat, bool kMean, class T>
[[gnu::always_inline]] inline LobeMoments<kWhat, T> both_lobes(const Lobes<T>& l, const T& t1, const T& t2) {
  auto m = front_lobe<kWhat, kMean>(l, t1, t2);
  const auto back = back_lobe<kWhat, kMean>(l, t1, t2);
  for (int i = 0; i < LobeMoments<kWhat, T>::kParts; ++i) {
    m.part[i].m0 = (m.part[i].m0 + back.part[i].m0) * T(0.25);
    m.part[i].m1 = (m.part[i].m1 + back.part[i].m1) * T(0.25);
  }
  return m;
}

/// Moments of radial / r^2, from the moments of `radial`.
template <bool kMean, class T>
[[gnu::always_inline]] inline Moments<T> radial_over_r2(const Lobes<T>& l, const Moments<T>& radial, const T& t1,
                                                        const T& t2) {
  const T inv_r2 = T(1) / l.r2;
  Moments<T> m{radial.m0 * inv_r2, radial.m1 * inv_r2};
  // As r -> 0 the radial parts of the lobes cancel, and r^2 divides the rest. So integrate radial / r^2 = 4 (n.h)^2 /
  // (1 - u^2)^3 directly. It is smooth: all poles are near t = +- i.
  const auto rough = l.r2 < T(0.01f);
  if (any(rough)) {
    LobeMoments<Parts::value, T> direct;
    gauss<1>(kGauss16, t1, t2, gauss_scales<kMean>(t1, t2), direct.part, [&](const T& t, T* out) {
      const T inv_a = T(1) / (T(1) + t * t);
      const T nh = ((T(1) - t * t) * l.hz - T(2) * t * l.hx) * inv_a;
      const T inv = T(1) / (T(1) - l.r2 * nh * nh);
      out[0] = T(4) * nh * nh * inv * inv * inv;
    });
    m.m0 = select(rough, direct.part[0].m0, m.m0);
    m.m1 = select(rough, direct.part[0].m1, m.m1);
  }
  return m;
}

template <bool kMean, class T>
[[gnu::always_inline]] inline MomentDerivatives<T> all_derivatives(const Lobes<T>& l, const T& t1, const T& t2) {
  const auto m = both_lobes<Parts::all, kMean>(l, t1, t2);
  return {m.part[0], m.part[1], radial_over_r2<kMean>(l, m.part[2], t1, t2)};
}

}  // namespace detail

/// m0 = integral of W dt, m1 = integral of (t - tm) W dt over [t1, t2], tm its middle.
template <class T>
Moments<T> moments(const Lobes<T>& l, const T& t1, const T& t2) {
  return detail::both_lobes<Parts::value, false>(l, t1, t2).part[0];
}

/// moments() with derivatives by h and alpha.
template <class T>
MomentDerivatives<T> moments_with_derivatives(const Lobes<T>& l, const T& t1, const T& t2) {
  return detail::all_derivatives<false>(l, t1, t2);
}

/// Means instead of integrals: m0 = mean of W over [t1, t2], m1 = mean of W times the position in [t1, t2], from -1 to
/// 1. Valid also in the limit t1 = t2, which edges along the groove need.
template <class T>
Moments<T> mean_moments(const Lobes<T>& l, const T& t1, const T& t2) {
  return detail::both_lobes<Parts::value, true>(l, t1, t2).part[0];
}
template <class T>
MomentDerivatives<T> mean_moments_with_derivatives(const Lobes<T>& l, const T& t1, const T& t2) {
  return detail::all_derivatives<true>(l, t1, t2);
}

}  // namespace burin::footprint
