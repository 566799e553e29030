// burin/render/fast/kernel/curves.h - pieces of a groove with light as a curve across it: the curve of a pair, and the
// sums of a piece. docs/model.md 10.8 to 10.12, burin/render/fast/curve_tables.h.
#pragma once

#include <cstdint>

#include "burin/render/fast/curve_tables.h"
#include "burin/render/fast/kernel/pieces.h"
#include "burin/render/fast/kernel/work.h"

namespace burin::kernel {

/// Curves of a tile: R and its derivatives.
enum CurveSet : std::uint8_t { kCurveLight, kCurveTurn, kCurveAlpha, kCurveAcross, kCurveAlong };

/// The knot before a pair's pixel (as RunCurve::number), the weight of the knot after it, and the factor of a single
/// knot's light.
template <class P>
struct PairCurve {
  P number, share, gain;
};
/// run(k): the run of lane k; Y: of the middles of the pairs' pixels.
template <class P, class Run>
[[gnu::always_inline]] inline PairCurve<P> pair_curve(const TileCurves& curves, const Run& run, const P& Y) {
  P of[4];
  packet::four_columns(of, [&](int k) { return &curves.runs[run(k)].number; });
  const P far = (Y - of[1]) * of[2], zero(0.0F), one(1.0F);
  const P at = xsimd::min(xsimd::max(far, zero), of[3] + one);
  const P knot = xsimd::max(xsimd::min(xsimd::floor(at), of[3]), zero);
  return {xsimd::select(of[0] < zero, of[0] - knot, of[0] + knot), at - knot,
          xsimd::select(of[3] < zero, xsimd::max(one + far, zero), one)};
}

/// A position on the curves of a SIMD vector of pieces.
template <class P>
struct CurvePlace {
  alignas(64) std::uint32_t at[kLanesOf<P>];  ///< in floats: the node before the position
  P within;                                   ///< distance from this node, in steps
};
template <class P>
[[gnu::always_inline]] inline CurvePlace<P> curve_place(const TileCurves& curves, const P& number, const P& t) {
  CurvePlace<P> p;
  const P half(static_cast<float>(curves.half_count));
  const P place = xsimd::select(number < P(0.0F), P(-t), t) * P(1 / curves.step) + half;
  const P node = xsimd::max(xsimd::min(xsimd::floor(place), half + half - P(1.0F)), P(0.0F));
  p.within = xsimd::min(xsimd::max(place - node, P(0.0F)), P(1.0F));
  alignas(64) float nodes[kLanesOf<P>], numbers[kLanesOf<P>];
  node.store_aligned(nodes);
  xsimd::abs(number).store_aligned(numbers);
  const auto knot_floats = static_cast<std::uint32_t>(curves.knot_floats);
  for (int k = 0; k < kLanesOf<P>; ++k)
    p.at[k] = (static_cast<std::uint32_t>(static_cast<int>(numbers[k])) - 1) * knot_floats +
              kCurveNode * static_cast<std::uint32_t>(static_cast<int>(nodes[k]));
  return p;
}

/// R at a position, and its integrals from t = 0.
template <class P>
struct OnCurve {
  P light, sum, sum_of_sums;
};
/// `number`, `share`: as in PairCurve; `between`: any lane has a nonzero share.
template <class P>
[[gnu::always_inline]] inline OnCurve<P> on_curve(const TileCurves& curves, CurveSet set, const CurvePlace<P>& p,
                                                  const P& number, const P& share, bool between) {
  const float* from = curves.knots.data() + set * curves.curve_floats;
  P a[4], b[4];
  packet::four_columns(a, [&](int k) { return from + p.at[k]; });
  packet::four_columns(b, [&](int k) { return from + p.at[k] + kCurveNode; });
  if (between) {
    P c[4], d[4];
    from += curves.knot_floats;
    packet::four_columns(c, [&](int k) { return from + p.at[k]; });
    packet::four_columns(d, [&](int k) { return from + p.at[k] + kCurveNode; });
    for (int i = 0; i < 3; ++i) {
      a[i] += share * (c[i] - a[i]);
      b[i] += share * (d[i] - b[i]);
    }
  }
  // The polynomial of the fifth degree with these values and derivatives at both ends.
  const P d0 = b[0] - a[0] - a[1] - a[2], d1 = b[1] - a[1] - P(2.0F) * a[2], d2 = b[2] - a[2];
  const P a3 = P(10.0F) * d0 - P(4.0F) * d1 + d2, a4 = P(7.0F) * d1 - P(15.0F) * d0 - P(2.0F) * d2,
          a5 = P(6.0F) * d0 - P(3.0F) * d1 + d2;
  const P& u = p.within;
  const P per_step(1 / curves.step);
  OnCurve<P> out;
  out.sum_of_sums = a[0] + u * (a[1] + u * (a[2] + u * (a3 + u * (a4 + u * a5))));
  const P sum = per_step * (a[1] + u * (P(2.0F) * a[2] + u * (P(3.0F) * a3 + u * (P(4.0F) * a4 + u * (P(5.0F) * a5)))));
  out.sum = xsimd::select(number < P(0.0F), P(-sum), sum);
  out.light = per_step * per_step * (P(2.0F) * a[2] + u * (P(6.0F) * a3 + u * (P(12.0F) * a4 + u * (P(20.0F) * a5))));
  return out;
}

/// Means over pieces: of R, and of R times the position from -1 to 1.
template <class P>
struct CurveMeans {
  P m0, m1;
};
template <class P>
[[gnu::always_inline]] inline CurveMeans<P> curve_means(const TileCurves& curves, const OnCurve<P>& a,
                                                        const OnCurve<P>& b, const P& length) {
  // Differences over short pieces lose their digits, so R counts as linear there.
  const MaskOf<P> is_short = length < P(0.1F * curves.step);
  const P half(0.5F), per = inverse(xsimd::select(is_short, P(1.0F), length));
  const P m0 = (b.sum - a.sum) * per;
  const P m1 = (a.sum + b.sum - P(2.0F) * per * (b.sum_of_sums - a.sum_of_sums)) * per;
  return {xsimd::select(is_short, half * (a.light + b.light), m0),
          xsimd::select(is_short, (b.light - a.light) * P(1.0F / 6), m1)};
}

/// Counterpart of rest_of_pieces() for curves.
template <class P, KernelMode kMode>
BURIN_FLATTEN inline void curve_pieces(const TileCurves& curves, TileBuffers& buffers, int i) {
  const P t1 = load<P>(buffers.t1 + i), t2 = load<P>(buffers.t2 + i), number = load<P>(buffers.curve + i),
          share = load<P>(buffers.share + i);
  const bool between = xsimd::any(share > P(0.0F));
  const CurvePlace<P> from = curve_place(curves, number, t1), to = curve_place(curves, number, t2);
  const P length = t2 - t1, half(0.5F);
  const auto means = [&](CurveSet set) {
    return curve_means(curves, on_curve(curves, set, from, number, share, between),
                       on_curve(curves, set, to, number, share, between), length);
  };
  const P top1 = load<P>(buffers.top1 + i), top2 = load<P>(buffers.top2 + i), bottom1 = load<P>(buffers.bottom1 + i),
          bottom2 = load<P>(buffers.bottom2 + i);
  const P top = half * (top1 + top2), bottom = half * (bottom1 + bottom2);
  const P dtop = half * (top2 - top1), dbottom = half * (bottom2 - bottom1);
  const P height = top - bottom, rise = dtop - dbottom;
  const CurveMeans<P> m = means(kCurveLight);
  save(buffers.piece_V + i, length * (height * m.m0 + rise * m.m1));
  if constexpr (kMode != KernelMode::value) {
    const CurveMeans<P> by_turn = means(kCurveTurn);
    const P first = half * (t1 + t2) * m.m0 + half * length * m.m1;
    save(buffers.piece_shift + i, P(2.0F) * rise * m.m0);
    save(buffers.piece_turn + i,
         P(-2.0F) * ((top * dtop - bottom * dbottom) * m.m0 + (dtop * dtop - dbottom * dbottom) * m.m1) +
             length * (height * by_turn.m0 + rise * by_turn.m1));
    save(buffers.piece_mean + i, length * m.m0);
    save(buffers.piece_first + i, length * first);
    if constexpr (kMode == KernelMode::material) {
      const CurveMeans<P> by_alpha = means(kCurveAlpha);
      save(buffers.piece_radial + i, -length * (height * by_alpha.m0 + rise * by_alpha.m1));
      save(buffers.piece_width + i, P(2.0F) * rise * first);
      if (curves.knot_floats > (kCurveAlpha + 1) * curves.curve_floats)
        for (const bool along : {false, true}) {
          const CurveMeans<P> by = means(along ? kCurveAlong : kCurveAcross);
          save((along ? buffers.piece_along : buffers.piece_across) + i, length * (height * by.m0 + rise * by.m1));
        }
    }
  }
}

/// Evaluates pieces 0 .. count - 1, of lobes or of curves.
template <class P, KernelMode kMode, bool kCurves>
inline void evaluate_any_pieces(const TileTask& task, TileBuffers& buffers, int count) {
  if constexpr (!kCurves)
    evaluate_pieces<P, kMode>(buffers, count);
  else
    for (int i = 0; i < count; i += kLanesOf<P>) curve_pieces<P, kMode>(*task.curves, buffers, i);
}

/// Counterpart of shade() for curves: the factors of finish_crossing() and finish(), without shading.
template <class P, KernelMode kMode>
[[gnu::always_inline]] inline void curve_factors(const TileTask& task, TileBuffers& buffers, const std::uint16_t* place,
                                                 const P& gain, int at) {
  save(buffers.gain + at, gain);
  if constexpr (kMode != KernelMode::value) save(buffers.base + at, packet::look_up<P>(task.base, place));
  if constexpr (kMode == KernelMode::material) save(buffers.by_alpha + at, P(0.0F));
}

/// Counterpart of rim_light(): light at the rims that bound the groove; the piece extends from lo to hi.
template <class P>
[[gnu::always_inline]] inline P curve_rim_light(const TileCurves& curves, const PairCurve<P>& of, const P& lo,
                                                const P& hi, const P& rim, const P& at_lo, const P& at_hi) {
  const bool between = xsimd::any(of.share > P(0.0F));
  const auto light = [&](const P& t) {
    return on_curve(curves, kCurveLight, curve_place(curves, of.number, t), of.number, of.share, between).light;
  };
  return xsimd::select(hi < rim, P(0.0F), at_hi * light(rim)) +
         xsimd::select(lo > -rim, P(0.0F), at_lo * light(P(-rim)));
}

}  // namespace burin::kernel
