// burin/render/fast/kernel/cut_pairs.h - pairs of several pieces: their pixels have corners on the groove, or meet an
// end of the scratch. They are cut into pieces group by group; the pieces are packed, so that SIMD vectors stay full.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "burin/render/fast/kernel/crossing.h"
#include "burin/render/fast/kernel/curves.h"
#include "burin/render/fast/kernel/lines.h"
#include "burin/render/fast/kernel/pieces.h"
#include "burin/render/fast/kernel/shading.h"
#include "burin/render/fast/kernel/work.h"

namespace burin::kernel {

/// A SIMD vector of pairs in their scratches' units. Y counts from a point in each pixel, so it keeps its digits
/// (make_lines()).
template <class P>
struct CutPacket {
  Edges<P> pixel;
  P origin_Y, first, second;  ///< Y of this point, and of the scratch's ends relative to it
  P alpha, rim, unit;
  P hx, hy, hz;        ///< the half vector in the scratch's frame
  PairCurve<P> curve;  ///< in place of the half vector, if light is a curve
};

/// Region with n.h > 0: between lo and hi; empty in dark lanes; the whole groove in all lanes unless `partly`.
template <class P>
struct Facing {
  P lo, hi;
  MaskOf<P> dark;
  bool partly;
};
template <class P, bool kCurves>
[[gnu::always_inline]] inline Facing<P> facing_of(const CutPacket<P>& c) {
  if constexpr (kCurves) return {-c.rim, c.rim, MaskOf<P>(false), false};
  const auto limits = footprint::front_facing(c.hx, c.hz, c.rim);
  return {limits.lo, limits.hi, limits.lo >= limits.hi, xsimd::any((limits.lo > -c.rim) | (limits.hi < c.rim))};
}

template <class P, KernelMode kMode, bool kCurves>
[[gnu::always_inline]] inline CutPacket<P> cut_packet(const TileWork& work, const ScatteredPacket& packet) {
  TileBuffers& buffers = work.buffers;
  alignas(64) std::uint16_t place[kLanesOf<P>];
  const auto used = [&](int k) { return std::min(k, packet.lanes - 1); };
  for (int k = 0; k < kLanesOf<P>; ++k) place[k] = work.places.place[packet.pair[used(k)]];
  make_lines<P>(
      work.task, [&](int k) { return buffers.live[packet.line[used(k)]]; }, buffers.line, 0, place);
  const auto constant = [&](Line c) { return load<P>(buffers.line[c]); };
  CutPacket<P> c;
  c.pixel =
      edges_of<P>(work.task, place, Middle<P>{constant(kMidCoarse), constant(kMidFine), constant(kMidY)}, constant);
  c.origin_Y = constant(kOriginY);
  c.first = constant(kFirstEnd) - c.origin_Y;
  c.second = constant(kSecondEnd) - c.origin_Y;
  c.alpha = constant(kAlpha);
  c.rim = constant(kRim);
  c.unit = constant(kUnit);
  if constexpr (kCurves) {
    c.curve = pair_curve<P>(
        *work.task.curves, [&](int k) { return buffers.live[packet.line[used(k)]]; }, constant(kMidY) + c.origin_Y);
    curve_factors<P, kMode>(work.task, buffers, place, c.curve.gain, packet.at);
    c.alpha = P(1.0F);
    return c;
  }
  const Shading<P> px = shade<P, kMode>(work.task, buffers, place, c.alpha, packet.at);
  const P across_x = constant(kAcrossX), across_y = constant(kAcrossY);
  c.hx = across_x * px.h_x + across_y * px.h_y;
  c.hy = across_x * px.h_y - across_y * px.h_x;
  c.hz = px.h_z;
  return c;
}

/// Number of breakpoints: corners alone, or also intersections of the pixel's edges with the scratch's ends.
template <bool kEnds>
inline constexpr int kBreaks = kEnds ? 8 : 4;

/// Values of t within the groove at which top or bottom changes its slope, in order.
template <class P, bool kEnds>
[[gnu::always_inline]] inline void breakpoints(const CutPacket<P>& c, P (&t)[kBreaks<kEnds>]) {
  const Edges<P>& e = c.pixel;
  for (int k = 0; k < 4; ++k) t[k] = e.t[k];
  if constexpr (kEnds) {
    for (int k = 4; k < 8; ++k) t[k] = k % 2 == 0 ? c.rim : -c.rim;
    for (int k = 0; k < 4; ++k) {
      const int j = (k + 1) % 4;
      const P dY = e.Y[j] - e.Y[k];
      const P per_Y = (e.t[j] - e.t[k]) * inverse(xsimd::select(dY == P(0.0F), P(1.0F), dY));
      for (int end = 0; end < 2; ++end) {
        const P& level = end == 0 ? c.first : c.second;
        const MaskOf<P> crosses = ((e.Y[k] < level) & (e.Y[j] >= level)) | ((e.Y[j] < level) & (e.Y[k] >= level));
        const P at = e.t[k] + (level - e.Y[k]) * per_Y;
        t[4 + 2 * end] = xsimd::select(crosses, xsimd::min(t[4 + 2 * end], at), t[4 + 2 * end]);
        t[5 + 2 * end] = xsimd::select(crosses, xsimd::max(t[5 + 2 * end], at), t[5 + 2 * end]);
      }
    }
  }
  for (P& v : t) v = xsimd::min(xsimd::max(v, -c.rim), c.rim);
  // Batcher's networks for eight and for four.
  constexpr int kNetwork[19][2] = {{0, 1}, {2, 3}, {4, 5}, {6, 7}, {0, 2}, {1, 3}, {4, 6}, {5, 7}, {1, 2}, {5, 6},
                                   {0, 4}, {1, 5}, {2, 6}, {3, 7}, {2, 4}, {3, 5}, {1, 2}, {3, 4}, {5, 6}};
  constexpr int kNetworkOf4[5][2] = {{0, 1}, {2, 3}, {0, 2}, {1, 3}, {1, 2}};
  if constexpr (kEnds)
#pragma GCC unroll 19
    for (const auto& n : kNetwork) order(t[n[0]], t[n[1]]);
  else
#pragma GCC unroll 5
    for (const auto& n : kNetworkOf4) order(t[n[0]], t[n[1]]);
}

/// Levels of the footprint cut with the scratch at each breakpoint.
template <class P, int kCount>
[[gnu::always_inline]] inline void levels_at(const CutPacket<P>& c, const P (&t)[kCount], P (&top)[kCount],
                                             P (&bottom)[kCount]) {
  const Edges<P>& e = c.pixel;
#pragma GCC unroll 8
  for (int k = 0; k < kCount; ++k) {
    e.levels(t[k], c.first, c.second, top[k], bottom[k]);
    // The outermost corners have no height, nor has the first breakpoint on them. An edge along the groove there is a
    // piece of zero length with a rise.
    MaskOf<P> outside = (t[k] < e.t_min) | (t[k] > e.t_max);
    if (k == 0)
      outside = outside | (t[k] == e.t_min);
    else
      outside = outside | ((t[k] == e.t_min) & (t[k - 1] < e.t_min));
    if (k == kCount - 1)
      outside = outside | (t[k] == e.t_max);
    else
      outside = outside | ((t[k] == e.t_max) & (t[k + 1] > e.t_max));
    close_where(outside, top[k], bottom[k]);
  }
}

/// Ends of the scratch that bound a piece: 1 or 0.
template <class P>
struct EndsOfPiece {
  P first, second;
};

/// An end bounds a piece if it is between the pixel's edges. Edges meet the end at breakpoints. There rounding moves an
/// edge slightly, or far if it is steep, so the test uses the piece's middle.
template <class P>
[[gnu::always_inline]] inline EndsOfPiece<P> ends_of_piece(const CutPacket<P>& c, const Piece<P>& p) {
  const P middle = P(0.5F) * (p.t1 + p.t2);
  P upper(1e30F), lower(-1e30F);
  c.pixel.cut_levels(middle, upper, lower);
  const MaskOf<P> within = (middle > c.pixel.t_min) & (middle < c.pixel.t_max);
  return {xsimd::select(within & (lower < c.first) & (upper > c.first), P(1.0F), P(0.0F)),
          xsimd::select(within & (lower < c.second) & (upper > c.second), P(1.0F), P(0.0F))};
}

/// Appends the pieces of the lanes selected by `bits` to the buffers.
template <class P, KernelMode kMode, bool kCurves>
[[gnu::always_inline]] inline void pack_pieces(TileBuffers& buffers, const CutPacket<P>& c, const Piece<P>& p,
                                               const EndsOfPiece<P>& on, std::uint32_t bits, int from) {
  const int n = buffers.piece_count;
  packet::pack(buffers.t1 + n, p.t1, bits);
  packet::pack(buffers.t2 + n, p.t2, bits);
  packet::pack(buffers.top1 + n, p.top1, bits);
  packet::pack(buffers.top2 + n, p.top2, bits);
  packet::pack(buffers.bottom1 + n, p.bottom1, bits);
  packet::pack(buffers.bottom2 + n, p.bottom2, bits);
  if constexpr (kCurves) {
    packet::pack(buffers.curve + n, c.curve.number, bits);
    packet::pack(buffers.share + n, c.curve.share, bits);
  } else {
    packet::pack(buffers.hx + n, c.hx, bits);
    packet::pack(buffers.hy + n, c.hy, bits);
    packet::pack(buffers.hz + n, c.hz, bits);
  }
  packet::pack(buffers.piece_alpha + n, c.alpha, bits);
  if constexpr (kMode != KernelMode::value) {
    packet::pack(buffers.on_first + n, on.first, bits);
    packet::pack(buffers.on_second + n, on.second, bits);
  }
  for (std::uint32_t left = bits; left != 0; left &= left - 1)
    buffers.piece_owner[buffers.piece_count++] = static_cast<std::uint16_t>(from + std::countr_zero(left));
}

/// Area of a SIMD vector of pairs, and the parts of its derivatives.
template <class P>
struct CutArea {
  P area, by_first, by_second, alone;
};

/// `heights` of limit_moves(), if n.h > 0 does not hold over the whole groove.
template <class P>
[[gnu::always_inline]] inline P heights_at_limits(const CutPacket<P>& c, const P& lo, const P& hi) {
  const Edges<P>& e = c.pixel;
  P sum(0.0F);
  for (const P* at : {&lo, &hi}) {
    P top, bottom;
    e.levels(*at, c.first, c.second, top, bottom);
    const MaskOf<P> cut = (xsimd::abs(*at) < c.rim) & (*at > e.t_min) & (*at < e.t_max);
    sum += xsimd::select(cut, (top - bottom) * *at, P(0.0F));
  }
  return sum;
}

/// Stores quantities that do not depend on the pieces' light: areas, and the derivatives by moving limits.
template <class P, KernelMode kMode, bool kCurves, int kCount>
[[gnu::always_inline]] inline void store_areas(const TileTask& task, TileBuffers& buffers, const CutPacket<P>& c,
                                               const Facing<P>& facing, const CutArea<P>& sum, const P (&top)[kCount],
                                               const P (&bottom)[kCount], int from) {
  constexpr int kLast = kCount - 1;
  const P height0 = top[0] - bottom[0], height1 = top[kLast] - bottom[kLast];
  const P shift = height1 - height0;
  save(buffers.origin_Y + from, c.origin_Y);
  save(buffers.a_shift + from, c.unit * shift);
  save(buffers.a_turn + from,
       c.unit * (sum.alone - P(0.5F) * (height1 * (top[kLast] + bottom[kLast]) - height0 * (top[0] + bottom[0])) -
                 c.origin_Y * shift));
  save(buffers.a_first + from, c.unit * sum.by_first);
  save(buffers.a_second + from, c.unit * sum.by_second);
  LimitMoves<P> moves{P(0.0F), P(0.0F), P(0.0F)};
  if constexpr (!kCurves)
    if (facing.partly)
      moves = limit_moves(c.hx, c.hy, c.hz,
                          P(xsimd::select(facing.dark, P(0.0F), heights_at_limits(c, facing.lo, facing.hi))));
  save(buffers.moving_turn + from, moves.turn);
  if constexpr (kMode == KernelMode::material) {
    P rims;
    if constexpr (kCurves)
      rims = curve_rim_light(*task.curves, c.curve, facing.lo, facing.hi, c.rim, height0, height1);
    else
      rims = rim_light(c.hx, c.hy, c.hz, c.alpha, facing.lo, facing.hi, c.rim, height0, height1);
    save(buffers.rim_light + from, xsimd::select(facing.dark, P(0.0F), rims));
    save(buffers.a_rim + from, c.unit * (height0 + height1));
    save(buffers.rim + from, c.rim);
    save(buffers.moving_across + from, moves.across);
    save(buffers.moving_along + from, moves.along);
  }
}

/// Cuts one SIMD vector of pairs at the pixels' corners and, with kEnds, at the intersections of their edges with the
/// scratch's ends. Each pair has at most three or seven pieces.
template <class P, KernelMode kMode, bool kEnds, bool kCurves>
BURIN_FLATTEN inline void cut(const TileWork& work, const ScatteredPacket& packet) {
  TileBuffers& buffers = work.buffers;
  const int from = packet.at;
  const CutPacket<P> c = cut_packet<P, kMode, kCurves>(work, packet);
  P t[kBreaks<kEnds>], top[kBreaks<kEnds>], bottom[kBreaks<kEnds>];
  breakpoints<P, kEnds>(c, t);
  levels_at(c, t, top, bottom);
  const Facing<P> facing = facing_of<P, kCurves>(c);
  CutArea<P> sum{P(0.0F), P(0.0F), P(0.0F), P(0.0F)};
#pragma GCC unroll 7
  for (int k = 0; k + 1 < kBreaks<kEnds>; ++k) {
    Piece<P> p{t[k], t[k + 1], top[k], top[k + 1], bottom[k], bottom[k + 1]};
    const P length = p.t2 - p.t1, height1 = p.top1 - p.bottom1, height2 = p.top2 - p.bottom2;
    sum.area += P(0.5F) * length * (height1 + height2);
    const MaskOf<P> tall = (height1 > P(0.0F)) | (height2 > P(0.0F));
    EndsOfPiece<P> on{P(0.0F), P(0.0F)};
    if constexpr (kEnds) {
      on = ends_of_piece(c, p);
      sum.by_first -= on.first * length;
      sum.by_second += on.second * length;
      sum.alone -= (on.first - on.second) * length * P(0.5F) * (p.t1 + p.t2);
    }
    MaskOf<P> nothing = facing.dark | !tall;
    if (facing.partly) nothing = nothing | clip(p, facing.lo, facing.hi);
    MaskOf<P> keep = !nothing;
    if constexpr (kMode == KernelMode::value)
      keep = keep & (p.t2 > p.t1);
    else
      keep = keep & ((p.t2 > p.t1) | ((p.top2 - p.bottom2) != (p.top1 - p.bottom1)));
    const std::uint32_t bits = packet::bits_of<P>(keep) & lane_bits(packet.lanes);
    if (bits != 0) pack_pieces<P, kMode, kCurves>(buffers, c, p, on, bits, from);
  }
  save(buffers.area + from, c.unit * sum.area);
  save(buffers.alpha + from, c.alpha);
  save(buffers.unit + from, c.unit);
  if constexpr (kMode != KernelMode::value)
    store_areas<P, kMode, kCurves>(work.task, buffers, c, facing, sum, top, bottom, from);
}

/// Evaluates the pieces of cut() and adds their results to their pairs.
template <class P, KernelMode kMode, bool kEnds, bool kCurves>
BURIN_FLATTEN inline void add_pieces(const TileTask& task, TileBuffers& buffers) {
  // Neutral pieces up to a full SIMD vector.
  for (int i = buffers.piece_count; i < buffers.piece_count + kLanesOf<P>; ++i) {
    buffers.t1[i] = buffers.t2[i] = buffers.top1[i] = buffers.top2[i] = buffers.bottom1[i] = buffers.bottom2[i] =
        buffers.hx[i] = buffers.hy[i] = 0;
    buffers.hz[i] = buffers.curve[i] = 1;
    buffers.share[i] = 0;
    buffers.piece_alpha[i] = 0.5F;
  }
  evaluate_any_pieces<P, kMode, kCurves>(task, buffers, buffers.piece_count);
  using Four = float __attribute__((vector_size(16)));
  for (int i = 0; i < buffers.piece_count; i += kLanesOf<P>) {
    const int n = std::min(kLanesOf<P>, buffers.piece_count - i);
    const std::uint16_t* owner = buffers.piece_owner + i;
    alignas(64) float rows[kLanesOf<P>][4];
    const auto add = [&](const P(&columns)[4], int at) {
      packet::four_rows(columns, rows);
      for (int k = 0; k < n; ++k) {
        Four sum, more;
        std::memcpy(&sum, buffers.total[owner[k]] + at, sizeof(Four));
        std::memcpy(&more, rows[k], sizeof(Four));
        sum += more;
        std::memcpy(buffers.total[owner[k]] + at, &sum, sizeof(Four));
      }
    };
    if constexpr (kMode == KernelMode::value) {
      for (int k = 0; k < n; ++k) buffers.total[owner[k]][0] += buffers.piece_V[i + k];
      continue;
    }
    P turn = load<P>(buffers.piece_turn + i), by_first = P(0.0F), by_second = P(0.0F), width = P(0.0F),
      radial = P(0.0F);
    if constexpr (kEnds) {
      const P first = load<P>(buffers.on_first + i), second = load<P>(buffers.on_second + i),
              mean = load<P>(buffers.piece_mean + i);
      // An edge opposite an end turns alone (between two edges this part cancels).
      turn -= (first - second) * load<P>(buffers.piece_first + i);
      by_first = -first * mean;
      by_second = second * mean;
    }
    if constexpr (kMode == KernelMode::material) {
      width = load<P>(buffers.piece_width + i);
      radial = load<P>(buffers.piece_radial + i);
    }
    add({load<P>(buffers.piece_V + i), load<P>(buffers.piece_shift + i), turn, width}, 0);
    if constexpr (kEnds || kMode == KernelMode::material) add({by_first, by_second, radial, P(0.0F)}, 4);
    if (kMode == KernelMode::material && task.by_half_vector)
      add({load<P>(buffers.piece_across + i), load<P>(buffers.piece_along + i), P(0.0F), P(0.0F)}, 8);
  }
  buffers.piece_count = 0;
}

/// Factors of one SIMD vector of pairs with summed pieces, their light in their pixels, and their derivatives.
template <class P, KernelMode kMode, bool kEnds>
BURIN_FLATTEN inline void finish(const TileWork& work, const ScatteredPacket& packet) {
  TileBuffers& buffers = work.buffers;
  TilePairs& pairs = work.pairs;
  const TileJacobian& to = work.jacobian;
  const std::uint32_t *pair = packet.pair, *line = packet.line;
  const int i = packet.at, lanes = packet.lanes;
  const P gain = load<P>(buffers.unit + i) * load<P>(buffers.gain + i);
  P total[8];
  packet::four_columns(total, [&](int k) { return buffers.total[i + k]; });
  if constexpr (kEnds || kMode == KernelMode::material)
    packet::four_columns(total + 4, [&](int k) { return buffers.total[i + k] + 4; });
  const P &V = total[0], light = gain * V;
  alignas(64) float out[kLanesOf<P>];
  const auto scatter = [&](float* array, const P& v) {
    v.store_aligned(out);
    for (int k = 0; k < lanes; ++k) array[pair[k]] = out[k];
  };
  std::uint16_t place[kLanesOf<P>] = {};
  for (int k = 0; k < lanes; ++k) place[k] = work.places.place[pair[k]];
  add_to_pixels(light, load<P>(buffers.area + i), place, lanes, buffers.sums);
  if (work.task.keep_light) scatter(pairs.light.data(), light);
  if constexpr (kMode != KernelMode::value) {
    const P base = load<P>(buffers.base + i), area_shift = load<P>(buffers.a_shift + i),
            area_turn = load<P>(buffers.a_turn + i);
    scatter(to.shift, gain * total[1] - base * area_shift);
    const P turn = total[2] - load<P>(buffers.origin_Y + i) * total[1];
    scatter(to.turn, gain * (turn + load<P>(buffers.moving_turn + i)) - base * area_turn);
    scatter(buffers.area_shift.data(), area_shift);
    scatter(buffers.area_turn.data(), area_turn);
    if constexpr (kEnds) {
      alignas(64) float first[kLanesOf<P>], second[kLanesOf<P>];
      (gain * total[4] - base * load<P>(buffers.a_first + i)).store_aligned(first);
      (gain * total[5] - base * load<P>(buffers.a_second + i)).store_aligned(second);
      for (int k = 0; k < lanes; ++k)
        pairs.ends.push_back(
            {pair[k], buffers.live[line[k]], first[k], second[k], buffers.a_first[i + k], buffers.a_second[i + k]});
    }
    if constexpr (kMode == KernelMode::material) {
      const P area_rim = load<P>(buffers.a_rim + i), area_width = load<P>(buffers.rim + i) * area_rim,
              alpha = load<P>(buffers.alpha + i);
      scatter(buffers.area_rim.data(), area_rim);
      scatter(buffers.area_width.data(), area_width);
      scatter(to.width, gain * (V + total[3]) - base * area_width);
      scatter(to.rim, gain * load<P>(buffers.rim_light + i) - base * area_rim);
      scatter(to.alpha, gain * (V * load<P>(buffers.by_alpha + i) - alpha * total[6]));
      if (work.task.by_half_vector) {
        P half[4];
        packet::four_columns(half, [&](int k) { return buffers.total[i + k] + 8; });
        scatter(to.h_across, gain * (half[0] + load<P>(buffers.moving_across + i)));
        scatter(to.h_along, gain * (half[1] + load<P>(buffers.moving_along + i)));
      }
    }
  }
}

/// Deferred pairs, group by group: cut, evaluate the pieces, and store the results by pair.
template <class P, KernelMode kMode, bool kEnds, bool kCurves>
inline void finish_set_aside(const TileWork& work, const PairsSetAside& aside) {
  constexpr std::size_t kGroup = TileBuffers::kPieces / kBreaks<kEnds>;
  static_assert(kGroup <= TileBuffers::kChunk);
  TileBuffers& buffers = work.buffers;
  for (std::size_t group = 0; group < aside.count; group += kGroup) {
    const int n = static_cast<int>(std::min(kGroup, aside.count - group));
    const auto packet_at = [&](int i) {
      return ScatteredPacket{&aside.pair[group + i], &aside.line[group + i], i, std::min(kLanesOf<P>, n - i)};
    };
    buffers.piece_count = 0;
    std::memset(buffers.total, 0, (n + kLanesOf<P>)*sizeof(buffers.total[0]));
    for (int i = 0; i < n; i += kLanesOf<P>) cut<P, kMode, kEnds, kCurves>(work, packet_at(i));
    add_pieces<P, kMode, kEnds, kCurves>(work.task, buffers);
    for (int i = 0; i < n; i += kLanesOf<P>) finish<P, kMode, kEnds>(work, packet_at(i));
  }
}

}  // namespace burin::kernel
