// burin/render/footprint/footprint_lobe.h - moments of one lobe of the groove's NDF over an interval, in closed form if
// it keeps digits. Part of burin/render/footprint/footprint_core.h, whose top comment defines the variables; include
// that file.
//
// R^2 + R and its derivatives are c0 + sum over j of (a_j + b_j tau) / N^j with N = tau^2 + s^2. So all follow from
//   J_j = integral of 1 / N^j,   K_j = integral of tau / N^j   over [tau1, tau2],
// and the first moments from integral of tau^2 / N^j = J_(j-1) - s^2 J_j. The following differences do not cancel. With
// tau = s tan(theta), Delta = theta2 - theta1, Sigma = theta1 + theta2, rho = 1 / sqrt(N1 N2),
//   cos Delta = (s^2 + tau1 tau2) rho,   sin Delta = s (tau2 - tau1) rho,
//   chi = 1 + cos Sigma = 1 - y,   y = (tau1 tau2 - s^2) rho,   or s^2 (tau1 + tau2)^2 rho^2 / (1 + y) where y > 0,
//   v = sin Delta / (1 + |cos Delta|) in [0, 1],   2 atan v = Delta, or pi - Delta where cos Delta < 0,
//   J1 = Delta / s,
//   J2 = (F2 + chi sin Delta) / (2 s^3),                                                F2 = Delta - sin Delta,
//   J3 = (F3 + chi sin Delta (sin^2(Delta/2) + chi cos(Delta) / 4)) / s^5,
//                                                         F3 = 3 Delta / 8 - sin(Delta) / 2 + sin(2 Delta) / 16.
// All terms have one sign. F2 and F3 vanish as Delta^3 and Delta^5. With atan v = v - v^3/3 + v^5 S(v^2), where S is a
// polynomial, and x = v^2, for cos Delta >= 0,
//   F2 = 2 v^3 (x S - 1/3 + 1 / (1 + x)),   F3 = v^5 (3/4 S + (1 - x) / (4 (1 + x)^2)),   1 / (1 + x) = cos^2(Delta/2).
// Odd integrals: K1 = log(N2 / N1) / 2 by log1p of |N2 - N1| / min(N1, N2),   K2 = (N2 - N1) / (2 N1 N2),
//   K3 = K2 (1/N1 + 1/N2) / 2,   N2 - N1 = (tau2 - tau1) (tau1 + tau2).
//
// Far poles. The lobe's poles are tau = +- i s. Short intervals, and the back lobe near normal incidence, are far from
// them relative to their length. There the first moment of the closed form cancels, and Gauss-Legendre quadrature
// converges fast. Let z^2 = (tau_m^2 + s^2) / (half length)^2 with tau_m the middle. n nodes err by (z + sqrt(z^2 -
// 1))^(-2n) times a factor. In double, z >= 2 uses 16 nodes. In float the front lobe uses the closed form up to z = 8,
// where its m1 has lost z roundings, and 4 nodes beyond. The back lobe uses 5 nodes from z = 2.5, and the closed form
// below.
#pragma once

#include <cmath>
#include <cstddef>
#include <iterator>

namespace burin::footprint {

/// Divisions, roots and logarithms of a type. On machines with estimate instructions, SIMD vectors replace slow
/// instructions by an estimate and one Newton step, exact to rounding (burin/render/fast/packet_math.h).
template <class T>
struct Arithmetic {
  static T inverse(const T& x) { return T(1) / x; }
  static T inverse_sqrt(const T& x) {
    using std::sqrt;
    return T(1) / sqrt(x);
  }
  static T log1p(const T& x) {  ///< x >= 0
    using std::log1p;
    return log1p(x);
  }
};

/// Integrands: W alone; W and its derivative by hx (hy, hz held, as for a scratch that turns on the face); or W and its
/// derivatives by turn and radial, which span all others.
enum class Parts { value, value_and_hx, all };

// Scalar versions of the functions of SIMD vectors.
inline double select(bool mask, double a, double b) { return mask ? a : b; }
inline float select(bool mask, float a, float b) { return mask ? a : b; }
inline bool any(bool mask) { return mask; }

namespace detail {

template <class T>
struct ScalarOf {
  using Type = T;
};
template <class T>
requires requires { typename T::value_type; }
struct ScalarOf<T> {
  using Type = typename T::value_type;
};

// S of the top comment, by Chebyshev interpolation on [0, 1] in 60 digits: error 3e-17 and 9e-8.
template <class Scalar>
inline constexpr Scalar kAtanTail[] = {
    0.199999999999999971,     -0.1428571428571196261,     0.11111111110800308347,    -0.090909090743209898084,
    0.076923072215557655365,  -0.066666584552271567048,   0.058822569252980760155,   -0.052623611121849675083,
    0.047570213883472280133,  -0.043250693380059073335,   0.039175717616372086719,   -0.034675428255362129378,
    0.029050265316797118103,  -0.022078360375884560235,   0.014506008933374108611,   -0.0078264851961408685248,
    0.0032727988311361973066, -0.00098337357889954519751, 0.00018744826491494326072, -0.000016938631029633110852};
template <>
inline constexpr float kAtanTail<float>[] = {0.19999990973f,  -0.14284550739f,  0.11085805587f,  -0.088741501188f,
                                             0.067356314111f, -0.041821829774f, 0.017279097149f, -0.0033530895588f};

// Half of the nodes of a Gauss-Legendre rule on [-1, 1] (the other half is mirrored), with half their weights: a mean.
struct Node {
  double x, mean_weight;
};
template <std::size_t n>
struct Rule {
  Node node[n];
  double middle;  // mean weight of a node at 0, if the rule has one
};
inline constexpr Rule<8> kGauss16 = {{{0.98940093499164993260, 0.027152459411754094852 / 2},
                                      {0.94457502307323257608, 0.062253523938647892863 / 2},
                                      {0.86563120238783174388, 0.095158511682492784810 / 2},
                                      {0.75540440835500303390, 0.12462897125553387205 / 2},
                                      {0.61787624440264374845, 0.14959598881657673208 / 2},
                                      {0.45801677765722738634, 0.16915651939500253819 / 2},
                                      {0.28160355077925891323, 0.18260341504492358887 / 2},
                                      {0.095012509837637440185, 0.18945061045506849629 / 2}},
                                     0};
inline constexpr Rule<2> kGauss5 = {
    {{0.90617984593866399280, 0.23692688505618908751 / 2}, {0.53846931010568309104, 0.47862867049936646804 / 2}},
    0.56888888888888888889 / 2};
inline constexpr Rule<2> kGauss4 = {
    {{0.86113631159405257522, 0.34785484513745385737 / 2}, {0.33998104358485626480, 0.65214515486254614263 / 2}}, 0};

template <class T>
T square(const T& x) {
  return x * x;
}

}  // namespace detail

/// m0 and m1 of footprint_core.h.
template <class T>
struct Moments {
  T m0, m1;
};

namespace detail {

// Scales from raw sums to moments (or means, see mean_moments). A closed sum is over d tau and (tau - tau_m) d tau. A
// Gauss sum is a mean over the interval, of 1 and of the position in [-1, 1].
template <class T>
struct Scales {
  T zeroth, first;
};

template <bool kMean, class T>
Scales<T> closed_scales(const T& p, const T& t1, const T& t2) {
  const T length = t2 - t1;
  const T scale = Arithmetic<T>::inverse(kMean ? p * length : p);
  return {scale, kMean ? T(2) * scale * scale : scale * scale};
}

template <bool kMean, class T>
Scales<T> gauss_scales(const T& t1, const T& t2) {
  if constexpr (kMean) return {T(1), T(1)};
  const T length = t2 - t1;
  return {length, T(0.5) * length * length};
}

// J[0] is the length of the interval.
template <int kPower, class T>
struct LobeIntegrals {
  T J[kPower + 1], K[kPower + 1];
};

template <int kPower, class T>
[[gnu::always_inline]] inline LobeIntegrals<kPower, T> lobe_integrals(const T& s, const T& inv_s, const T& s2,
                                                                      const T& tau1, const T& tau2, const T& delta) {
  using std::abs;
  using std::max;
  using Scalar = typename ScalarOf<T>::Type;
  constexpr Scalar kHalfPi = Scalar(1.57079632679489661923);
  LobeIntegrals<kPower, T> I;
  const T N1 = tau1 * tau1 + s2, N2 = tau2 * tau2 + s2;
  const T sum = tau1 + tau2, product = tau1 * tau2;
  const T rho = Arithmetic<T>::inverse_sqrt(N1 * N2), inv_NN = rho * rho;
  const T c = (s2 + product) * rho, sn = s * delta * rho;
  const auto narrow = c >= T(0);
  const T v = sn * Arithmetic<T>::inverse(T(1) + abs(c)), x = v * v;
  // S(x) as even and odd terms side by side, which halves the latency of one long chain.
  constexpr std::size_t terms = std::size(kAtanTail<Scalar>);
  static_assert(terms % 2 == 0);
  const T x2 = x * x;
  T even = T(kAtanTail<Scalar>[terms - 2]), odd = T(kAtanTail<Scalar>[terms - 1]);
  for (std::size_t i = terms - 2; i > 0; i -= 2) {
    even = even * x2 + T(kAtanTail<Scalar>[i - 2]);
    odd = odd * x2 + T(kAtanTail<Scalar>[i - 1]);
  }
  const T S = even + x * odd;
  const T v3 = v * x, inv_1x = T(0.5) + T(0.5) * abs(c);  // 1 / (1 + x) = cos^2 of half the angle
  const T twice_atan = T(2) * (v + v3 * (x * S - T(Scalar(1) / Scalar(3))));
  const T Delta = select(narrow, twice_atan, T(2 * kHalfPi) - twice_atan);
  const T inv_s2 = inv_s * inv_s;
  const T away = (product - s2) * rho;
  const T chi =
      select(away > T(0), s2 * sum * sum * inv_NN * Arithmetic<T>::inverse(T(1) + max(away, T(0))), T(1) - away);
  I.J[0] = delta;
  I.J[1] = Delta * inv_s;
  const T F2 = select(narrow, T(2) * v3 * (x * S - T(Scalar(1) / Scalar(3)) + inv_1x), Delta - sn);
  const T lean = chi * sn;
  I.J[2] = T(0.5) * (F2 + lean) * inv_s * inv_s2;
  const T difference = delta * sum;  // N2 - N1
  const T log_ratio = Arithmetic<T>::log1p(abs(difference) * max(N1, N2) * inv_NN);
  I.K[0] = T(0.5) * difference;
  I.K[1] = T(0.5) * select(difference >= T(0), log_ratio, -log_ratio);
  I.K[2] = T(0.5) * difference * inv_NN;
  if constexpr (kPower >= 3) {
    const T F3 = select(narrow, v3 * x * (T(0.75) * S + T(0.25) * (T(1) - x) * inv_1x * inv_1x),
                        T(0.375) * Delta - sn * (T(0.5) - T(0.125) * c));
    const T sin2_half = T(0.5) * (T(1) - c);
    const T sin2_half_narrow = x * inv_1x;
    I.J[3] = (F3 + lean * (select(narrow, sin2_half_narrow, sin2_half) + T(0.25) * chi * c)) * inv_s * inv_s2 * inv_s2;
    I.K[3] = T(0.5) * I.K[2] * (N1 + N2) * inv_NN;
  }
  return I;
}

// c0 + sum over j = 1 .. kPower of (a[j] + b[j] tau) / N^j.
template <int kPower, class T>
struct LobePolynomial {
  T c0, a[kPower + 1], b[kPower + 1];
};

template <int kPower, int kAll, class T>
[[gnu::always_inline]] inline Moments<T> integrate(const LobePolynomial<kPower, T>& f, const LobeIntegrals<kAll, T>& I,
                                                   const T& s2, const T& tau_m, const Scales<T>& scales) {
  T m0 = f.c0 * I.J[0], m1 = T(0);
  for (int j = 1; j <= kPower; ++j) {
    m0 = m0 + f.a[j] * I.J[j] + f.b[j] * I.K[j];
    m1 = m1 + f.a[j] * (I.K[j] - tau_m * I.J[j]) + f.b[j] * (I.J[j - 1] - s2 * I.J[j] - tau_m * I.K[j]);
  }
  return {m0 * scales.zeroth, m1 * scales.first};
}

// (A + (a1 + b1 tau)/N + (a2 + b2 tau)/N^2) * (c + (a + b tau)/N).
template <class T>
[[gnu::always_inline]] inline LobePolynomial<3, T> times(const LobePolynomial<2, T>& f, const T& c, const T& a,
                                                         const T& b, const T& s2) {
  LobePolynomial<3, T> g;
  g.c0 = c * f.c0;
  g.a[1] = c * f.a[1] + f.c0 * a + f.b[1] * b;
  g.b[1] = c * f.b[1] + f.c0 * b;
  g.a[2] = c * f.a[2] + f.a[1] * a - f.b[1] * b * s2 + f.b[2] * b;
  g.b[2] = c * f.b[2] + f.a[1] * b + f.b[1] * a;
  g.a[3] = f.a[2] * a - f.b[2] * b * s2;
  g.b[3] = f.a[2] * b + f.b[2] * a;
  return g;
}

// R and its polynomials for one lobe: R = A + (g - f tau) / N.
template <class T>
struct LobeForm {
  T A, g, f, e, s2;

  [[gnu::always_inline]] LobePolynomial<2, T> weighted(const T& squares,
                                                       const T& ones) const {  // squares * R^2 + ones * R
    LobePolynomial<2, T> w;
    const T slope = T(2) * A * squares + ones;
    w.c0 = A * (A * squares + ones);
    w.a[1] = slope * g + squares * f * f;
    w.b[1] = -(slope * f);
    w.a[2] = squares * (g * g - f * f * s2);
    w.b[2] = T(-2) * squares * g * f;
    return w;
  }
};

// Moments of a lobe's value, R^2 + R, and on request of its derivatives: part 1 by hx, or parts 1, 2 by turn and
// radial.
template <Parts kWhat, class T>
struct LobeMoments {
  static constexpr int kParts = kWhat == Parts::all ? 3 : kWhat == Parts::value_and_hx ? 2 : 1;
  Moments<T> part[kParts];
};

template <Parts kWhat, class T>
[[gnu::always_inline]] inline LobeMoments<kWhat, T> lobe_closed(const T& p, const T& e, const T& r, const T& s2,
                                                                const T& s, const T& inv_s, const T& t1, const T& t2,
                                                                const Scales<T>& scales) {
  const T tau1 = p * t1 + e, tau2 = p * t2 + e, delta = p * (t2 - t1), tau_m = T(0.5) * (tau1 + tau2);
  const T A = Arithmetic<T>::inverse(p);
  const LobeForm<T> R{A, T(2) * (T(1) - s2 * A), T(2) * e * A, e, s2};
  LobeMoments<kWhat, T> m;
  const auto I = lobe_integrals < kWhat == Parts::value ? 2 : 3 > (s, inv_s, s2, tau1, tau2, delta);
  m.part[0] = integrate(R.weighted(T(1), T(1)), I, s2, tau_m, scales);
  if constexpr (kWhat == Parts::value_and_hx) {
    // (R^2 + R)' = (2 R^2 + R) (-2 r t / Q1), and t / Q1 = (tau - e) / N
    const T two_r = T(2) * r;
    m.part[1] = integrate(times(R.weighted(T(2), T(1)), T(0), two_r * e, T(-two_r), s2), I, s2, tau_m, scales);
  }
  if constexpr (kWhat == Parts::all) {
    m.part[1] = integrate(times(R.weighted(T(2), T(1)), e * A, -(R.f * s2), -R.g, s2), I, s2, tau_m, scales);
    // 2 R^3 - R^2 - R = (2 R^2 - R - 1) R
    LobePolynomial<2, T> w = R.weighted(T(2), T(-1));
    w.c0 = w.c0 - T(1);
    m.part[2] = integrate(times(w, A, R.g, -R.f, s2), I, s2, tau_m, scales);
  }
  return m;
}

// Moments over [t1, t2] of kParts integrands at once: integrand(t, out) fills out[kParts].
template <int kParts, class T, std::size_t n, class Integrand>
[[gnu::always_inline]] inline void gauss(const Rule<n>& rule, const T& t1, const T& t2, const Scales<T>& scales,
                                         Moments<T>* m, const Integrand& integrand) {
  using Scalar = typename ScalarOf<T>::Type;
  const T tm = T(0.5) * (t1 + t2), half = T(0.5) * (t2 - t1);
  for (int i = 0; i < kParts; ++i) m[i] = {T(0), T(0)};
  if (rule.middle != 0) {
    T v[kParts];
    integrand(tm, v);
    for (int i = 0; i < kParts; ++i) m[i].m0 = T(Scalar(rule.middle)) * v[i];
  }
  for (const Node& node : rule.node) {
    const T d = half * T(Scalar(node.x));
    T v[kParts], w[kParts];
    integrand(tm + d, v);
    integrand(tm - d, w);
    for (int i = 0; i < kParts; ++i) {
      m[i].m0 = m[i].m0 + T(Scalar(node.mean_weight)) * (v[i] + w[i]);
      m[i].m1 = m[i].m1 + T(Scalar(node.mean_weight * node.x)) * (v[i] - w[i]);
    }
  }
  for (int i = 0; i < kParts; ++i) {
    m[i].m0 = m[i].m0 * scales.zeroth;
    m[i].m1 = m[i].m1 * scales.first;
  }
}

// One lobe by Gauss-Legendre quadrature. The back lobe's R is at most 1 for n.h >= 0, so a direct sum gives its Q. The
// same holds for the front lobe if p < 1/2 (h far below the face), since its peak is out of reach.
template <Parts kWhat, bool kBack, class T, std::size_t n>
[[gnu::always_inline]] inline LobeMoments<kWhat, T> lobe_gauss(const Rule<n>& rule, const T& p, const T& q, const T& e,
                                                               const T& k, const T& r, const T& s2, const T& t1,
                                                               const T& t2, const Scales<T>& scales) {
  LobeMoments<kWhat, T> m;
  const T inv_p = kBack ? p : Arithmetic<T>::inverse(p), two_e = e + e, two_r = r + r;
  gauss<LobeMoments<kWhat, T>::kParts>(rule, t1, t2, scales, m.part, [&](const T& t, T* out) {
    const T a = T(1) + t * t;
    T Q = q + t * (two_e + p * t);
    if constexpr (!kBack) Q = select(p >= T(0.5), (square(p * t + e) + s2) * inv_p, Q);
    const T inv_Q = Arithmetic<T>::inverse(Q);
    const T R = a * inv_Q;
    out[0] = R * R + R;
    if constexpr (kWhat == Parts::value_and_hx) out[1] = -(out[0] + R * R) * (two_r * t) * inv_Q;
    if constexpr (kWhat == Parts::all) {
      out[1] = -(out[0] + R * R) * (T(2) * t * k + (T(1) - t * t) * e) * inv_Q;
      out[2] = (out[0] + R * R) * (R - T(1));
    }
  });
  return m;
}

template <Parts kWhat, class T>
void blend(LobeMoments<kWhat, T>& to, const LobeMoments<kWhat, T>& from, const auto& mask) {
  for (int i = 0; i < LobeMoments<kWhat, T>::kParts; ++i) {
    to.part[i].m0 = select(mask, from.part[i].m0, to.part[i].m0);
    to.part[i].m1 = select(mask, from.part[i].m1, to.part[i].m1);
  }
}

// Back lobe near its poles, which only low half vectors reach. A separate function, because it is rare. Replaces the
// lanes of `m` in the mask `near`.
template <Parts kWhat, bool kMean, class T>
[[gnu::noinline]] void lobe_back_near(LobeMoments<kWhat, T>& m, const T& p, const T& e, const T& r, const T& s2,
                                      const T& s, const T& inv_s, const T& t1, const T& t2, const auto& near) {
  blend(m, lobe_closed<kWhat>(p, e, r, s2, s, inv_s, t1, t2, closed_scales<kMean>(p, t1, t2)), near);
}

// The method of each lane depends on its interval alone. So results do not depend on the packing of work into vectors.
template <Parts kWhat, bool kMean, bool kBack, class T>
[[gnu::always_inline]] inline LobeMoments<kWhat, T> lobe(const T& p, const T& q, const T& e, const T& k, const T& r,
                                                         const T& s2, const T& s, const T& inv_s, const T& t1,
                                                         const T& t2) {
  constexpr bool kFloat = sizeof(typename ScalarOf<T>::Type) == 4;
  // Distance of the lobe's poles tau = +- i s from the interval's middle, relative to its half length.
  const T tau_m = T(0.5) * p * (t1 + t2) + e, half = T(0.5) * p * (t2 - t1);
  const T poles2 = tau_m * tau_m + s2, half2 = half * half;
  const auto scales = gauss_scales<kMean>(t1, t2);
  if constexpr (!kFloat) {
    if (poles2 >= T(4) * half2) return lobe_gauss<kWhat, kBack>(kGauss16, p, q, e, k, r, s2, t1, t2, scales);
    return lobe_closed<kWhat>(p, e, r, s2, s, inv_s, t1, t2, closed_scales<kMean>(p, t1, t2));
  } else if constexpr (!kBack) {
    auto m = lobe_closed<kWhat>(p, e, r, s2, s, inv_s, t1, t2, closed_scales<kMean>(p, t1, t2));
    const auto far = poles2 >= T(64) * half2;
    if (any(far)) blend(m, lobe_gauss<kWhat, kBack>(kGauss4, p, q, e, k, r, s2, t1, t2, scales), far);
    return m;
  } else {
    auto m = lobe_gauss<kWhat, kBack>(kGauss5, p, q, e, k, r, s2, t1, t2, scales);
    const auto near = poles2 < T(6.25F) * half2;
    if (any(near)) lobe_back_near<kWhat, kMean>(m, p, e, r, s2, s, inv_s, t1, t2, near);
    return m;
  }
}

}  // namespace detail
}  // namespace burin::footprint
