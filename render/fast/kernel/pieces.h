// burin/render/fast/kernel/pieces.h - a groove's pieces between breakpoints, and their footprint integrals.
// docs/model.md 4.
#pragma once

#include <cstdint>
#include <xsimd/xsimd.hpp>

#include "burin/render/fast/kernel/work.h"

namespace burin::kernel {

template <class P>
struct Piece {
  P t1, t2, top1, top2, bottom1, bottom2;
};

/// Cuts a piece to [lo, hi]; returns the lanes with an empty result.
template <class P>
[[gnu::always_inline]] inline MaskOf<P> clip(Piece<P>& p, const P& lo, const P& hi) {
  const P ta = xsimd::max(p.t1, lo), tb = xsimd::min(p.t2, hi);
  const P length = p.t2 - p.t1;
  const P per_t = inverse(xsimd::select(length > P(0.0F), length, P(1.0F)));
  const P fa = (ta - p.t1) * per_t, fb = (tb - p.t1) * per_t;
  const P dtop = p.top2 - p.top1, dbottom = p.bottom2 - p.bottom1;
  const MaskOf<P> empty = ta > tb;
  const MaskOf<P> cut = ((ta > p.t1) | (tb < p.t2)) & (length > P(0.0F));
  p.top2 = xsimd::select(cut, p.top1 + fb * dtop, p.top2);
  p.top1 = xsimd::select(cut, p.top1 + fa * dtop, p.top1);
  p.bottom2 = xsimd::select(cut, p.bottom1 + fb * dbottom, p.bottom2);
  p.bottom1 = xsimd::select(cut, p.bottom1 + fa * dbottom, p.bottom1);
  p.t1 = ta;
  p.t2 = tb;
  return empty;
}

template <class P, footprint::Parts kParts>
BURIN_FLATTEN inline void front_of_pieces(TileBuffers& buffers, int i) {
  const auto lobes = footprint::make_lobes(load<P>(buffers.hx + i), load<P>(buffers.hy + i), load<P>(buffers.hz + i),
                                           load<P>(buffers.piece_alpha + i));
  const auto m = footprint::front_lobe<kParts, true>(lobes, load<P>(buffers.t1 + i), load<P>(buffers.t2 + i));
  for (int k = 0; k < m.kParts; ++k) {
    save(buffers.front[2 * k] + i, m.part[k].m0);
    save(buffers.front[2 * k + 1] + i, m.part[k].m1);
  }
  if constexpr (kParts == footprint::Parts::all) return;
  const P* const kept[7] = {&lobes.e, &lobes.k, &lobes.p, &lobes.q, &lobes.s2, &lobes.inv_s, &lobes.r};
  for (int k = 0; k < 7; ++k) save(buffers.lobes[k] + i, *kept[k]);
}

/// The lobes of front_of_pieces().
template <class P, footprint::Parts kParts>
[[gnu::always_inline]] inline footprint::Lobes<P> lobes_of_pieces(const TileBuffers& buffers, int i) {
  if constexpr (kParts == footprint::Parts::all)
    return footprint::make_lobes(load<P>(buffers.hx + i), load<P>(buffers.hy + i), load<P>(buffers.hz + i),
                                 load<P>(buffers.piece_alpha + i));
  footprint::Lobes<P> lobes;
  P* const kept[7] = {&lobes.e, &lobes.k, &lobes.p, &lobes.q, &lobes.s2, &lobes.inv_s, &lobes.r};
  for (int k = 0; k < 7; ++k) *kept[k] = load<P>(buffers.lobes[k] + i);
  lobes.s = lobes.s2 * lobes.inv_s;
  return lobes;
}

template <class P, KernelMode kMode, footprint::Parts kParts>
BURIN_FLATTEN inline void rest_of_pieces(TileBuffers& buffers, int i) {
  const P t1 = load<P>(buffers.t1 + i), t2 = load<P>(buffers.t2 + i), hx = load<P>(buffers.hx + i),
          hy = load<P>(buffers.hy + i), hz = load<P>(buffers.hz + i);
  const auto lobes = lobes_of_pieces<P, kParts>(buffers, i);
  auto m = footprint::back_lobe<kParts, true>(lobes, t1, t2);
  for (int k = 0; k < m.kParts; ++k) {
    m.part[k].m0 = P(0.25F) * (m.part[k].m0 + load<P>(buffers.front[2 * k] + i));
    m.part[k].m1 = P(0.25F) * (m.part[k].m1 + load<P>(buffers.front[2 * k + 1] + i));
  }
  const P &m0 = m.part[0].m0, &m1 = m.part[0].m1;
  const P top1 = load<P>(buffers.top1 + i), top2 = load<P>(buffers.top2 + i), bottom1 = load<P>(buffers.bottom1 + i),
          bottom2 = load<P>(buffers.bottom2 + i);
  const P length = t2 - t1, half(0.5F);
  const P top = half * (top1 + top2), bottom = half * (bottom1 + bottom2);
  const P dtop = half * (top2 - top1), dbottom = half * (bottom2 - bottom1);
  const P height = top - bottom, rise = dtop - dbottom;
  save(buffers.piece_V + i, length * (height * m0 + rise * m1));
  if constexpr (kMode != KernelMode::value) {
    P by_hx;
    if constexpr (kMode == KernelMode::ends) {
      by_hx = length * (height * m.part[1].m0 + rise * m.part[1].m1);
    } else {
      const auto radial = footprint::detail::radial_over_r2<true>(lobes, m.part[2], t1, t2);
      const P by_radial = length * (height * radial.m0 + rise * radial.m1);
      const P by_lean = length * (height * m.part[1].m0 + rise * m.part[1].m1), per_H2 = inverse(lobes.H2);
      by_hx = (hx * lobes.r2 * by_radial + hz * by_lean) * per_H2;
      const P by_hz = (hz * lobes.r2 * by_radial - hx * by_lean) * per_H2, per_hz = inverse(hz);
      save(buffers.piece_across + i, by_lean * per_hz);
      save(buffers.piece_along + i, -(hy * per_hz * by_hz));
      save(buffers.piece_radial + i, by_radial);
      save(buffers.piece_width + i, P(2.0F) * rise * (half * (t1 + t2) * m0 + half * length * m1));
    }
    save(buffers.piece_shift + i, P(2.0F) * rise * m0);
    save(buffers.piece_turn + i,
         P(-2.0F) * ((top * dtop - bottom * dbottom) * m0 + (dtop * dtop - dbottom * dbottom) * m1) + hy * by_hx);
    save(buffers.piece_mean + i, length * m0);
    save(buffers.piece_first + i, length * (half * (t1 + t2) * m0 + half * length * m1));
  }
}

/// Evaluates pieces 0 .. count - 1, without the common factors of a pair's pieces. Two passes, one per lobe: a core
/// looks only some hundred instructions ahead, so this keeps several SIMD vectors in flight.
template <class P, KernelMode kMode>
inline void evaluate_pieces(TileBuffers& buffers, int count) {
  constexpr footprint::Parts kParts = kMode == KernelMode::value  ? footprint::Parts::value
                                      : kMode == KernelMode::ends ? footprint::Parts::value_and_hx
                                                                  : footprint::Parts::all;
  for (int i = 0; i < count; i += kLanesOf<P>) front_of_pieces<P, kParts>(buffers, i);
  for (int i = 0; i < count; i += kLanesOf<P>) rest_of_pieces<P, kMode, kParts>(buffers, i);
}

/// If n.h = 0 between the rims, this limit moves with h. Derivatives of V are by h turned with the scratch, and by its
/// components across and along the scratch. W is 1 there. `heights`: sum over the limits of the piece's height times t,
/// with the first limit's sign unchanged.
template <class P>
struct LimitMoves {
  P turn, across, along;
};
template <class P>
[[gnu::always_inline]] inline LimitMoves<P> limit_moves(const P& hx, const P& hy, const P& hz, const P& heights) {
  const P H2 = hx * hx + hz * hz, per_H = footprint::Arithmetic<P>::inverse_sqrt(H2), per_hz = inverse(hz);
  const P by_hx = -(heights * per_H), in_z = by_hx * per_hz * per_hz;
  return {hy * by_hx, in_z * H2, in_z * hx * hy};
}

/// Light at the rims that bound the groove: dV / d rim.
template <class P>
[[gnu::always_inline]] inline P rim_light(const P& hx, const P& hy, const P& hz, const P& alpha, const P& lo,
                                          const P& hi, const P& rim, const P& at_lo, const P& at_hi) {
  const auto lobes = footprint::make_lobes(hx, hy, hz, alpha);
  return xsimd::select(hi < rim, P(0.0F), at_hi * footprint::weight(lobes, rim)) +
         xsimd::select(lo > -rim, P(0.0F), at_lo * footprint::weight(lobes, P(-rim)));
}

}  // namespace burin::kernel
