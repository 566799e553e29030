// burin/render/fast/kernel/direct_pairs.h - pairs of a single piece: no corner of the pixel is on the groove, and an
// end in the pixel crosses the groove inside it. Most pairs are of this kind and are evaluated directly.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>

#include "burin/render/fast/kernel/crossing.h"
#include "burin/render/fast/kernel/curves.h"
#include "burin/render/fast/kernel/pieces.h"
#include "burin/render/fast/kernel/shading.h"
#include "burin/render/fast/kernel/work.h"

namespace burin::kernel {

/// Deferred pairs, as bits of the lanes.
struct SetAside {
  std::uint32_t corners, ends;
};

/// Crossings cut at a scratch's ends: their edges from a to b, and the lanes with several pieces or none.
template <class P>
struct WithinEnds {
  P top1, top2, bottom1, bottom2;
  MaskOf<P> raised1, capped1;     ///< at a: the first end bounds the piece, or the second
  MaskOf<P> ends, corners, none;  ///< deferred for an end, deferred for corners; without a single piece
};
template <class P>
[[gnu::always_inline]] inline WithinEnds<P> within_ends(const Crossing<P>& e, const P& first, const P& second,
                                                        const P& rim) {
  const MaskOf<P> apart = (e.t_min >= rim) | (e.t_max <= -rim) | (e.Y_min >= second) | (e.Y_max <= first);
  // At both ends of [a, b]: the pixel's edges, and whether an end of the scratch comes before them.
  P top1 = e.top1, top2 = e.top2, bottom1 = e.bottom1, bottom2 = e.bottom2;
  const MaskOf<P> capped1 = top1 > second, capped2 = top2 > second, raised1 = bottom1 < first,
                  raised2 = bottom2 < first;
  top1 = xsimd::min(top1, second);
  top2 = xsimd::min(top2, second);
  bottom1 = xsimd::max(bottom1, first);
  bottom2 = xsimd::max(bottom2, first);
  const MaskOf<P> closed1 = top1 < bottom1, closed2 = top2 < bottom2;
  const MaskOf<P> mixed = (capped1 != capped2) | (raised1 != raised2) | (closed1 != closed2);
  // An end across the pixel from a to b, or outside it, bounds a single piece as an edge does. So does a corner at a or
  // b. The exception is an edge of the pixel along the groove there, also on the rim: rounding may put a on either side
  // of it.
  const P near(1e-6F);
  const MaskOf<P> has_corner = (e.t_min > -rim - near) | (e.t_max < rim + near);
  const MaskOf<P> corner_between = (e.inside > P(0.0F)) | (e.along & has_corner);
  const MaskOf<P> in_reach = ((e.Y_min < first) | (e.Y_max > second)) & !apart;
  const MaskOf<P> ends = in_reach & (corner_between | mixed);
  const MaskOf<P> corners = corner_between & !(apart | in_reach);
  const MaskOf<P> none = apart | ends | corners | (closed1 & closed2);
  close_where(closed1, top1, bottom1);
  close_where(closed2, top2, bottom2);
  return {top1, top2, bottom1, bottom2, raised1, capped1, ends, corners, none};
}

/// One SIMD vector of pairs with one piece each, at `at`: the groove crosses the pixel from side to side, or enters
/// with an end square across it. Deferred pairs, and pairs whose pixel the groove misses, become empty pieces.
template <class P, KernelMode kMode, bool kOnLattice, bool kCurves>
[[gnu::always_inline]] BURIN_FLATTEN inline SetAside cross(const TileWork& work, const PairPacket& packet) {
  const TileTask& task = work.task;
  TileBuffers& buffers = work.buffers;
  const std::size_t pair = packet.pair;
  const int at = packet.at;
  const std::uint16_t* place = &work.places.place[pair];
  const packet::Picker<P> pick(packet.line);
  const auto constant = [&](Line c) { return pick(buffers.line[c]); };
  Crossing<P> e;
  if constexpr (kOnLattice)
    e = crossing_on_lattice<P>(place, constant);
  else
    e = crossing_of_corners<P>(task, place, constant);
  const P alpha = constant(kAlpha);
  const P first = constant(kFirstEnd), second = constant(kSecondEnd), rim = constant(kRim);
  P hx, hy, hz;
  PairCurve<P> curve;
  if constexpr (kCurves) {
    curve = pair_curve<P>(
        *task.curves, [&](int k) { return buffers.live[packet.line[k]]; }, middle_of<P>(place, constant).Y);
    curve_factors<P, kMode>(task, buffers, place, curve.gain, at);
  } else {
    const Shading<P> px = shade<P, kMode>(task, buffers, place, alpha, at);
    const P across_x = constant(kAcrossX), across_y = constant(kAcrossY);
    hx = across_x * px.h_x + across_y * px.h_y;
    hy = across_x * px.h_y - across_y * px.h_x;
    hz = px.h_z;
  }
  const WithinEnds<P> cut = within_ends(e, first, second, rim);
  const P &a = e.a, &b = e.b;
  const P &top1 = cut.top1, &top2 = cut.top2, &bottom1 = cut.bottom1, &bottom2 = cut.bottom2;
  const MaskOf<P>& none = cut.none;
  const P height1 = top1 - bottom1, height2 = top2 - bottom2;
  const P unit = xsimd::select(none, P(0.0F), constant(kUnit));
  // n.h > 0 between lo and hi. On a deep groove one wall often partly faces away.
  footprint::Limits<P> limits{-rim, rim};
  if constexpr (!kCurves) limits = footprint::front_facing(hx, hz, rim);
  const P lo = xsimd::max(limits.lo, a), hi = xsimd::min(limits.hi, b);
  const MaskOf<P> dark = none | (lo >= hi);
  const P length = b - a, per_length = inverse(length), at_lo = (lo - a) * per_length, at_hi = (hi - a) * per_length;
  const P dtop = top2 - top1, dbottom = bottom2 - bottom1;
  const Piece<P> p{
      lo, hi, top1 + at_lo * dtop, top1 + at_hi * dtop, bottom1 + at_lo * dbottom, bottom1 + at_hi * dbottom};
  const auto keep = [&](float* to, const P& v) { save(to + at, xsimd::select(dark, P(0.0F), v)); };
  // Empty pieces keep the length of their neighbors but have no height, because short ones would use another method.
  const MaskOf<P> away = limits.lo >= limits.hi;
  save(buffers.t1 + at, xsimd::select(dark, xsimd::select(away, P(0.0F), limits.lo), p.t1));
  save(buffers.t2 + at, xsimd::select(dark, xsimd::select(away, P(0.0F), limits.hi), p.t2));
  keep(buffers.top1, p.top1);
  keep(buffers.top2, p.top2);
  keep(buffers.bottom1, p.bottom1);
  keep(buffers.bottom2, p.bottom2);
  if constexpr (kCurves) {
    save(buffers.curve + at, curve.number);
    save(buffers.share + at, curve.share);
    save(buffers.piece_alpha + at, P(1.0F));
  } else {
    save(buffers.hx + at, hx);
    save(buffers.hy + at, hy);
    save(buffers.hz + at, hz);
    save(buffers.piece_alpha + at, alpha);
  }
  save(buffers.unit + at, unit);
  save(buffers.area + at, P(0.5F) * unit * length * (height1 + height2));
  if constexpr (kMode != KernelMode::value) {
    if constexpr (kCurves) {
      for (float* of : {buffers.moving_turn, buffers.moving_across, buffers.moving_along}) save(of + at, P(0.0F));
    } else {
      const LimitMoves<P> moves = limit_moves(hx, hy, hz,
                                              P(xsimd::select(lo > a, (p.top1 - p.bottom1) * lo, P(0.0F)) +
                                                xsimd::select(hi < b, (p.top2 - p.bottom2) * hi, P(0.0F))));
      keep(buffers.moving_turn, moves.turn);
      if constexpr (kMode == KernelMode::material) {
        keep(buffers.moving_across, moves.across);
        keep(buffers.moving_along, moves.along);
      }
    }
    save(&buffers.area_shift[pair], unit * (height2 - height1));
    const P on_first = xsimd::select(cut.raised1 & !none, P(1.0F), P(0.0F)),
            on_second = xsimd::select(cut.capped1 & !none, P(1.0F), P(0.0F));
    // An edge opposite an end turns alone.
    const P alone = (on_second - on_first) * length * (a + b);
    save(&buffers.area_turn[pair], P(0.5F) * unit * (alone + height1 * (top1 + bottom1) - height2 * (top2 + bottom2)));
    save(buffers.on_first + at, on_first);
    save(buffers.on_second + at, on_second);
    save(buffers.a_first + at, unit * length);
  }
  if constexpr (kMode == KernelMode::material) {
    const P area_rim = unit * (height1 + height2);
    save(&buffers.area_rim[pair], area_rim);
    save(&buffers.area_width[pair], rim * area_rim);
    if constexpr (kCurves)
      keep(buffers.rim_light, curve_rim_light(*task.curves, curve, lo, hi, rim, height1, height2));
    else
      keep(buffers.rim_light, rim_light(hx, hy, hz, alpha, lo, hi, rim, height1, height2));
  }
  return {packet::bits_of<P>(cut.corners), packet::bits_of<P>(cut.ends)};
}

/// Factors of one SIMD vector of cross()'s pairs, their light in their pixels, and their derivatives.
template <class P, KernelMode kMode>
[[gnu::always_inline]] BURIN_FLATTEN inline void finish_crossing(const TileWork& work, const PairPacket& packet) {
  TileBuffers& buffers = work.buffers;
  TilePairs& pairs = work.pairs;
  const TileJacobian& to = work.jacobian;
  const std::size_t pair = packet.pair;
  const int at = packet.at;
  const P gain = load<P>(buffers.unit + at) * load<P>(buffers.gain + at), V = load<P>(buffers.piece_V + at),
          light = gain * V;
  if (work.task.keep_light) save(&pairs.light[pair], light);
  if constexpr (kMode != KernelMode::value) {
    const P base = load<P>(buffers.base + at), first = load<P>(buffers.on_first + at),
            second = load<P>(buffers.on_second + at);
    // An edge opposite an end turns alone (between two edges this part cancels).
    const P turn = load<P>(buffers.piece_turn + at) - (first - second) * load<P>(buffers.piece_first + at);
    save(to.shift + pair, gain * load<P>(buffers.piece_shift + at) - base * load<P>(&buffers.area_shift[pair]));
    save(to.turn + pair, gain * (turn + load<P>(buffers.moving_turn + at)) - base * load<P>(&buffers.area_turn[pair]));
    // No test for an empty mask, because mispredicted branches cost more.
    const std::uint32_t bits = packet::bits_of<P>(first + second > P(0.0F)) & lane_bits(packet.lanes);
    const P area = load<P>(buffers.a_first + at), both = gain * load<P>(buffers.piece_mean + at) - base * area;
    TileBuffers::DirectEnds& ends = buffers.direct_ends;
    const int n = ends.count;
    packet::pack_numbers<P>(ends.line + n, ends.pair + n, packet.line, static_cast<std::uint32_t>(pair), bits);
    packet::pack(ends.first + n, P(-first * both), bits);
    packet::pack(ends.second + n, P(second * both), bits);
    packet::pack(ends.area_first + n, P(-first * area), bits);
    packet::pack(ends.area_second + n, P(second * area), bits);
    ends.count = n + std::popcount(bits);
    if constexpr (kMode == KernelMode::material) {
      const P alpha = load<P>(buffers.piece_alpha + at);
      save(to.width + pair, gain * (V + load<P>(buffers.piece_width + at)) - base * load<P>(&buffers.area_width[pair]));
      save(to.rim + pair, gain * load<P>(buffers.rim_light + at) - base * load<P>(&buffers.area_rim[pair]));
      save(to.alpha + pair, gain * (V * load<P>(buffers.by_alpha + at) - alpha * load<P>(buffers.piece_radial + at)));
      if (work.task.by_half_vector) {
        save(to.h_across + pair, gain * (load<P>(buffers.piece_across + at) + load<P>(buffers.moving_across + at)));
        save(to.h_along + pair, gain * (load<P>(buffers.piece_along + at) + load<P>(buffers.moving_along + at)));
      }
    }
  }
  add_to_pixels(light, load<P>(buffers.area + at), &work.places.place[pair], packet.lanes, buffers.sums);
}

/// Appends the ends of a chunk's finish_crossing().
inline void list_direct_ends(TileBuffers& buffers, TilePairs& pairs) {
  TileBuffers::DirectEnds& ends = buffers.direct_ends;
  for (int i = 0; i < ends.count; ++i)
    pairs.ends.push_back({ends.pair[i], buffers.live[ends.line[i]], ends.first[i], ends.second[i], ends.area_first[i],
                          ends.area_second[i]});
  ends.count = 0;
}

}  // namespace burin::kernel
