// render/pair_batch_impl.h - the kernel of render/pair_batch.h over a packet type.
//
// Included only by the files that are compiled for one instruction set each (pair_batch_*.cpp). Nothing here may be
// used under the same type by two of them: the linker keeps one copy of an inline function, and it might be the one
// that this machine cannot run. So everything depends on the packet type, which differs.
#pragma once

#include <xsimd/xsimd.hpp>

#include "render/footprint_core.h"
#include "render/pair_batch.h"

// A packet that is passed to a function goes through memory: inside these everything is inlined.
#define BURIN_FLATTEN __attribute__((flatten))

namespace burin::batch {

template <class P>
struct Kernel {
  using F = P;
  using Mask = typename P::batch_bool_type;
  static constexpr int kLanes = static_cast<int>(P::size);

  static F load(const float* p) { return F::load_unaligned(p); }
  static void store(float* p, const F& v) { v.store_unaligned(p); }
  static F zero() { return F(0.0F); }

  /// A convex polygon's edges as lines over t: tops run towards smaller t, bottoms towards larger t.
  struct Edges {
    F t[4], Y[4], slope[4];
    Mask is_top[4], is_bottom[4];
    F t_min, t_max;

    void make() {
      for (int i = 0; i < 4; ++i) {
        const int j = (i + 1) % 4;
        const F dt = t[j] - t[i];
        is_top[i] = dt < zero();
        is_bottom[i] = dt > zero();
        slope[i] = (Y[j] - Y[i]) / xsimd::select(is_top[i] | is_bottom[i], dt, F(1.0F));
      }
      t_min = xsimd::min(xsimd::min(t[0], t[1]), xsimd::min(t[2], t[3]));
      t_max = xsimd::max(xsimd::max(t[0], t[1]), xsimd::max(t[2], t[3]));
    }

    /// Between which levels the polygon lies at t, cut to [first, second]; one level twice where it does not.
    void levels(const F& at, const F& first, const F& second, F& top, F& bottom) const {
      top = second;
      bottom = first;
      for (int i = 0; i < 4; ++i) {
        const F line = Y[i] + slope[i] * (at - t[i]);
        top = xsimd::select(is_top[i], xsimd::min(top, line), top);
        bottom = xsimd::select(is_bottom[i], xsimd::max(bottom, line), bottom);
      }
      close_where(top < bottom, top, bottom);
    }
  };

  static void close_where(const Mask& mask, F& top, F& bottom) {
    const F middle = F(0.5F) * (top + bottom);
    top = xsimd::select(mask, middle, top);
    bottom = xsimd::select(mask, middle, bottom);
  }

  static void order(F& a, F& b) {
    const F low = xsimd::min(a, b);
    b = xsimd::max(a, b);
    a = low;
  }

  struct Piece {
    F t1, t2, top1, top2, bottom1, bottom2;
  };

  /// The part of a piece within [lo, hi]; an empty one has t1 = t2 and no height.
  static Mask clip(Piece& p, const F& lo, const F& hi) {
    const F ta = xsimd::max(p.t1, lo), tb = xsimd::min(p.t2, hi);
    const F length = p.t2 - p.t1;
    const F per_t = F(1.0F) / xsimd::select(length > zero(), length, F(1.0F));
    const F fa = (ta - p.t1) * per_t, fb = (tb - p.t1) * per_t;
    const F dtop = p.top2 - p.top1, dbottom = p.bottom2 - p.bottom1;
    const Mask empty = ta > tb;
    const Mask cut = ((ta > p.t1) | (tb < p.t2)) & (length > zero());
    p.top2 = xsimd::select(cut, p.top1 + fb * dtop, p.top2);
    p.top1 = xsimd::select(cut, p.top1 + fa * dtop, p.top1);
    p.bottom2 = xsimd::select(cut, p.bottom1 + fb * dbottom, p.bottom2);
    p.bottom1 = xsimd::select(cut, p.bottom1 + fa * dbottom, p.bottom1);
    p.t1 = ta;
    p.t2 = tb;
    return empty;
  }

  /// At t = 0 any half vector above the face is in front of the groove, so nothing is singular there.
  static void empty_where(const Mask& mask, Piece& p) {
    p.t1 = xsimd::select(mask, zero(), p.t1);
    p.t2 = xsimd::select(mask, zero(), p.t2);
    p.top1 = xsimd::select(mask, zero(), p.top1);
    p.top2 = xsimd::select(mask, zero(), p.top2);
    p.bottom1 = xsimd::select(mask, zero(), p.bottom1);
    p.bottom2 = xsimd::select(mask, zero(), p.bottom2);
  }

  static bool bit(std::uint64_t bits, int lane) { return ((bits >> lane) & 1U) != 0; }

  static std::uint64_t bits_of(const Mask& mask) {
    alignas(64) bool lanes[kLanes];
    mask.store_unaligned(lanes);
    std::uint64_t bits = 0;
    for (int i = 0; i < kLanes; ++i) bits |= static_cast<std::uint64_t>(lanes[i]) << i;
    return bits;
  }

  // What one piece gives, before the factors that are the same for all pieces of a pair.
  struct Sums {
    F V, shift, turn, width, radial, mean, first_moment;
  };

  template <BatchMode kMode>
  BURIN_FLATTEN static Sums evaluate(const Piece& p, const F& hx, const F& hy, const F& hz, const F& alpha) {
    const auto lobes = footprint::make_lobes(hx, hy, hz, alpha);
    const F length = p.t2 - p.t1, half(0.5F);
    const F top = half * (p.top1 + p.top2), bottom = half * (p.bottom1 + p.bottom2);
    const F dtop = half * (p.top2 - p.top1), dbottom = half * (p.bottom2 - p.bottom1);
    const F height = top - bottom, rise = dtop - dbottom;
    Sums s{};
    if constexpr (kMode == BatchMode::value) {
      const auto m = footprint::mean_moments(lobes, p.t1, p.t2);
      s.V = length * (height * m.m0 + rise * m.m1);
    } else {
      const auto d = footprint::mean_moments_with_derivatives(lobes, p.t1, p.t2);
      const F &m0 = d.value.m0, &m1 = d.value.m1;
      s.V = length * (height * m0 + rise * m1);
      s.shift = F(2.0F) * rise * m0;
      const F by_turn = length * (height * d.turn.m0 + rise * d.turn.m1);
      s.radial = length * (height * d.radial_over_r2.m0 + rise * d.radial_over_r2.m1);
      s.turn = F(-2.0F) * ((top * dtop - bottom * dbottom) * m0 + (dtop * dtop - dbottom * dbottom) * m1) +
               hy * (hx * lobes.r2 * s.radial + hz * by_turn) / lobes.H2;
      s.mean = length * m0;
      s.first_moment = length * (half * (p.t1 + p.t2) * m0 + half * length * m1);
      if constexpr (kMode == BatchMode::material)
        s.width = F(2.0F) * rise * (half * (p.t1 + p.t2) * m0 + half * length * m1);
    }
    return s;
  }

  /// Evaluates the extra pieces and adds what they give to their pairs.
  template <BatchMode kMode>
  __attribute__((noinline)) static void flush_extra(PairBatch& b) {
    // Harmless pieces up to a full packet.
    const int padded = (b.extra_count + kLanes - 1) / kLanes * kLanes;
    for (int i = b.extra_count; i < padded; ++i) {
      b.extra_t1[i] = b.extra_t2[i] = b.extra_top1[i] = b.extra_top2[i] = b.extra_bottom1[i] = b.extra_bottom2[i] = 0;
      b.extra_hx[i] = b.extra_hy[i] = 0;
      b.extra_hz[i] = 1;
      b.extra_alpha[i] = 0.5F;
    }
    for (int i = 0; i < b.extra_count; i += kLanes) {
      const Piece p{load(b.extra_t1 + i),   load(b.extra_t2 + i),      load(b.extra_top1 + i),
                    load(b.extra_top2 + i), load(b.extra_bottom1 + i), load(b.extra_bottom2 + i)};
      const Sums s =
          evaluate<kMode>(p, load(b.extra_hx + i), load(b.extra_hy + i), load(b.extra_hz + i), load(b.extra_alpha + i));
      alignas(64) float V[kLanes], shift[kLanes], turn[kLanes], width[kLanes], radial[kLanes], mean[kLanes],
          first_moment[kLanes];
      const int n = b.extra_count - i < kLanes ? b.extra_count - i : kLanes;
      store(V, s.V);
      for (int k = 0; k < n; ++k) b.raw_V[b.extra_lane[i + k]] += V[k];
      if constexpr (kMode != BatchMode::value) {
        store(shift, s.shift);
        store(turn, s.turn);
        store(mean, s.mean);
        store(first_moment, s.first_moment);
        for (int k = 0; k < n; ++k) {
          const int lane = b.extra_lane[i + k];
          b.raw_shift[lane] += shift[k];
          // An edge opposite an end turns alone (between two edges this part cancels).
          b.raw_turn[lane] += turn[k] - (b.extra_first[i + k] - b.extra_second[i + k]) * first_moment[k];
          b.raw_first[lane] -= b.extra_first[i + k] * mean[k];
          b.raw_second[lane] += b.extra_second[i + k] * mean[k];
        }
      }
      if constexpr (kMode == BatchMode::material) {
        store(width, s.width);
        store(radial, s.radial);
        for (int k = 0; k < n; ++k) {
          b.raw_width[b.extra_lane[i + k]] += width[k];
          b.raw_radial[b.extra_lane[i + k]] += radial[k];
        }
      }
    }
    b.extra_count = 0;
  }

  /// Appends a packet's pieces, where `bits` are set, for the lanes that `lane_of` names.
  template <BatchMode kMode, class LaneOf>
  __attribute__((noinline)) static void push_extra(PairBatch& b, const Piece& p, std::uint64_t bits, const float* hx,
                                                   const float* hy, const float* hz, const float* alpha,
                                                   const float* first, const float* second, const LaneOf& lane_of) {
    if (bits == 0) return;
    if (b.extra_count + 2 * kLanes > PairBatch::kPieces) flush_extra<kMode>(b);
    alignas(64) float t1[kLanes], t2[kLanes], top1[kLanes], top2[kLanes], bottom1[kLanes], bottom2[kLanes];
    store(t1, p.t1);
    store(t2, p.t2);
    store(top1, p.top1);
    store(top2, p.top2);
    store(bottom1, p.bottom1);
    store(bottom2, p.bottom2);
    int n = b.extra_count;
    for (; bits != 0; bits &= bits - 1) {
      const int k = __builtin_ctzll(bits);
      b.extra_lane[n] = lane_of(k);
      b.extra_t1[n] = t1[k];
      b.extra_t2[n] = t2[k];
      b.extra_top1[n] = top1[k];
      b.extra_top2[n] = top2[k];
      b.extra_bottom1[n] = bottom1[k];
      b.extra_bottom2[n] = bottom2[k];
      b.extra_hx[n] = hx[k];
      b.extra_hy[n] = hy[k];
      b.extra_hz[n] = hz[k];
      b.extra_alpha[n] = alpha[k];
      b.extra_first[n] = first == nullptr ? 0 : first[k];
      b.extra_second[n] = second == nullptr ? 0 : second[k];
      ++n;
    }
    b.extra_count = n;
  }

  // Where n.h > 0 does not reach over the whole groove, the limit moves as h turns (W is 1 there).
  static F cut_turn(const Edges& e, const F& lo, const F& hi, const F& rim, const F& first, const F& second,
                    const F& hx, const F& hy, const F& hz) {
    const F H = xsimd::sqrt(hx * hx + hz * hz);
    F sum = zero();
    for (const F* at : {&lo, &hi}) {
      F top, bottom;
      e.levels(*at, first, second, top, bottom);
      const Mask cut = (xsimd::abs(*at) < rim) & (*at > e.t_min) & (*at < e.t_max);
      sum += xsimd::select(cut, (top - bottom) * *at, zero());
    }
    return -sum * hy / H;
  }

  // Light at the rims, where they bound the groove: dV / d rim.
  static F rim_light(const F& hx, const F& hy, const F& hz, const F& alpha, const F& lo, const F& hi, const F& rim,
                     const F& at_lo, const F& at_hi) {
    const auto lobes = footprint::make_lobes(hx, hy, hz, alpha);
    return xsimd::select(hi < rim, zero(), at_hi * footprint::weight(lobes, rim)) +
           xsimd::select(lo > -rim, zero(), at_lo * footprint::weight(lobes, F(-rim)));
  }

  /// Geometry of one packet of pairs: areas, the first piece of each, further pieces pushed to `extra`.
  template <BatchMode kMode>
  BURIN_FLATTEN static void cut_packet(PairBatch& b, int i) {
    const F across_x = load(b.across_x + i), across_y = load(b.across_y + i), per_mm = load(b.per_mm + i);
    const F tx = across_x * per_mm, ty = across_y * per_mm, t_origin = load(b.t_origin + i);
    Edges e;
    F Y_min, Y_max;
    for (int k = 0; k < 4; ++k) {
      const F x = load(b.x[k] + i), y = load(b.y[k] + i);
      e.t[k] = tx * x + (ty * y + t_origin);
      e.Y[k] = tx * y - ty * x;
      store(b.x[k] + i, e.t[k]);
      store(b.y[k] + i, e.Y[k]);
      Y_min = k == 0 ? e.Y[0] : xsimd::min(Y_min, e.Y[k]);
      Y_max = k == 0 ? e.Y[0] : xsimd::max(Y_max, e.Y[k]);
    }
    const F h_x = load(b.h_x + i), h_y = load(b.h_y + i), hz = load(b.h_z + i), alpha = load(b.alpha + i);
    const F hx = across_x * h_x + across_y * h_y, hy = across_x * h_y - across_y * h_x;
    store(b.h_x + i, hx);
    store(b.h_y + i, hy);
    const F rim = load(b.rim + i), first = load(b.first_end + i), second = load(b.second_end + i);
    e.make();

    const Mask apart = (e.t_min >= rim) | (e.t_max <= -rim) | (Y_min >= second) | (Y_max <= first);
    const Mask end = ((Y_min < first) | (Y_max > second)) & (!apart);
    const Mask no = apart | end;

    // Corners in order across the groove; between them top and bottom are straight.
    F s0 = e.t[0], s1 = e.t[1], s2 = e.t[2], s3 = e.t[3];
    order(s0, s1);
    order(s2, s3);
    order(s0, s2);
    order(s1, s3);
    order(s1, s2);
    F t[4], top[4], bottom[4];
    const F corner[4] = {s0, s1, s2, s3};
    for (int k = 0; k < 4; ++k) {
      t[k] = xsimd::min(xsimd::max(corner[k], -rim), rim);
      e.levels(t[k], first, second, top[k], bottom[k]);
    }
    // The outermost corners have no height; an edge along the groove there is a piece without length but with a rise.
    close_where(s0 >= -rim, top[0], bottom[0]);
    close_where(s3 <= rim, top[3], bottom[3]);
    F height[4];
    for (int k = 0; k < 4; ++k) height[k] = top[k] - bottom[k];

    const F unit = F(1.0F) / (per_mm * per_mm);
    F area = zero();
    for (int k = 0; k < 3; ++k) area += F(0.5F) * (t[k + 1] - t[k]) * (height[k] + height[k + 1]);
    store(b.area + i, xsimd::select(no, zero(), unit * area));
    if constexpr (kMode != BatchMode::value) {
      store(b.area_shift + i, xsimd::select(no, zero(), unit * (height[3] - height[0])));
      store(b.area_turn + i,
            xsimd::select(no, zero(),
                          F(-0.5F) * unit * (height[3] * (top[3] + bottom[3]) - height[0] * (top[0] + bottom[0]))));
    }

    const auto limits = footprint::front_facing(hx, hz, rim);
    const Mask dark = (limits.lo >= limits.hi) | no;
    const bool any_cut = xsimd::any((limits.lo > -rim) | (limits.hi < rim));
    F turn = zero();
    if constexpr (kMode != BatchMode::value) {
      if (any_cut)
        turn = xsimd::select(dark, zero(), cut_turn(e, limits.lo, limits.hi, rim, first, second, hx, hy, hz));
    }
    if constexpr (kMode == BatchMode::material) {
      const F rims = rim_light(hx, hy, hz, alpha, limits.lo, limits.hi, rim, height[0], height[3]);
      store(b.raw_rim + i, xsimd::select(dark, zero(), rims));
      store(b.area_rim + i, xsimd::select(no, zero(), unit * (height[0] + height[3])));
      store(b.raw_width + i, zero());
      store(b.raw_radial + i, zero());
    }
    store(b.raw_V + i, zero());
    if constexpr (kMode != BatchMode::value) {
      store(b.raw_shift + i, zero());
      store(b.raw_turn + i, turn);
      store(b.raw_first + i, zero());
      store(b.raw_second + i, zero());
    }

    Piece main{};
    Mask has_main = dark;  // nothing to do there
    for (int k = 0; k < 3; ++k) {
      Piece p{t[k], t[k + 1], top[k], top[k + 1], bottom[k], bottom[k + 1]};
      Mask nothing = dark;
      if (any_cut) nothing = nothing | clip(p, limits.lo, limits.hi);
      const Mask flat = p.t2 <= p.t1;
      if constexpr (kMode == BatchMode::value)
        nothing = nothing | flat;
      else
        nothing = nothing | (flat & ((p.top2 - p.bottom2) == (p.top1 - p.bottom1)));
      const Mask take = !(nothing | has_main);
      if (k == 0) {
        main = p;
        empty_where(nothing, main);
      } else {
        main.t1 = xsimd::select(take, p.t1, main.t1);
        main.t2 = xsimd::select(take, p.t2, main.t2);
        main.top1 = xsimd::select(take, p.top1, main.top1);
        main.top2 = xsimd::select(take, p.top2, main.top2);
        main.bottom1 = xsimd::select(take, p.bottom1, main.bottom1);
        main.bottom2 = xsimd::select(take, p.bottom2, main.bottom2);
        const Mask more = has_main & (!nothing);
        if (xsimd::any(more))
          push_extra<kMode>(b, p, bits_of(more), b.h_x + i, b.h_y + i, b.h_z + i, b.alpha + i, nullptr, nullptr,
                            [i](int lane) { return i + lane; });
      }
      has_main = has_main | take;
    }
    store(b.piece_t1 + i, main.t1);
    store(b.piece_t2 + i, main.t2);
    store(b.piece_top1 + i, main.top1);
    store(b.piece_top2 + i, main.top2);
    store(b.piece_bottom1 + i, main.bottom1);
    store(b.piece_bottom2 + i, main.bottom2);

    if (xsimd::any(end)) {
      for (std::uint64_t bits = bits_of(end); bits != 0; bits &= bits - 1) {
        const int lane = i + __builtin_ctzll(bits);
        if (lane < b.count) b.end_lane[b.end_count++] = lane;
      }
    }
  }

  /// Geometry of a packet of pairs that an end of the scratch may bound: eight breakpoints, up to seven pieces.
  template <BatchMode kMode>
  BURIN_FLATTEN static void cut_end_packet(PairBatch& b, int from) {
    const int n = b.end_count - from < kLanes ? b.end_count - from : kLanes;
    alignas(64) float in[17][kLanes];
    for (int k = 0; k < kLanes; ++k) {
      const int lane = b.end_lane[from + (k < n ? k : 0)];
      for (int c = 0; c < 4; ++c) {
        in[c][k] = b.x[c][lane];
        in[4 + c][k] = b.y[c][lane];
      }
      in[8][k] = b.h_x[lane];
      in[9][k] = b.h_y[lane];
      in[10][k] = b.h_z[lane];
      in[11][k] = b.alpha[lane];
      in[12][k] = b.rim[lane];
      in[13][k] = b.first_end[lane];
      in[14][k] = b.second_end[lane];
      in[15][k] = b.per_mm[lane];
    }
    Edges e;
    for (int c = 0; c < 4; ++c) {
      e.t[c] = load(in[c]);
      e.Y[c] = load(in[4 + c]);
    }
    e.make();
    const F hx = load(in[8]), hy = load(in[9]), hz = load(in[10]), alpha = load(in[11]), rim = load(in[12]);
    const F first = load(in[13]), second = load(in[14]), per_mm = load(in[15]);

    F t[8] = {e.t[0], e.t[1], e.t[2], e.t[3], rim, -rim, rim, -rim};
    for (int k = 0; k < 4; ++k) {
      const int j = (k + 1) % 4;
      const F dY = e.Y[j] - e.Y[k];
      const F per_Y = (e.t[j] - e.t[k]) / xsimd::select(dY == zero(), F(1.0F), dY);
      for (int end = 0; end < 2; ++end) {
        const F& level = end == 0 ? first : second;
        const Mask crosses = ((e.Y[k] < level) & (e.Y[j] >= level)) | ((e.Y[j] < level) & (e.Y[k] >= level));
        const F at = e.t[k] + (level - e.Y[k]) * per_Y;
        t[4 + 2 * end] = xsimd::select(crosses, xsimd::min(t[4 + 2 * end], at), t[4 + 2 * end]);
        t[5 + 2 * end] = xsimd::select(crosses, xsimd::max(t[5 + 2 * end], at), t[5 + 2 * end]);
      }
    }
    for (F& v : t) v = xsimd::min(xsimd::max(v, -rim), rim);
    // Batcher's network for eight.
    constexpr int kNetwork[19][2] = {{0, 1}, {2, 3}, {4, 5}, {6, 7}, {0, 2}, {1, 3}, {4, 6}, {5, 7}, {1, 2}, {5, 6},
                                     {0, 4}, {1, 5}, {2, 6}, {3, 7}, {2, 4}, {3, 5}, {1, 2}, {3, 4}, {5, 6}};
    for (const auto& c : kNetwork) order(t[c[0]], t[c[1]]);

    F top[8], bottom[8];
    for (int k = 0; k < 8; ++k) {
      e.levels(t[k], first, second, top[k], bottom[k]);
      // As at the outermost corners above: no height beyond them, nor at the first breakpoint on them.
      Mask outside = (t[k] < e.t_min) | (t[k] > e.t_max);
      if (k == 0)
        outside = outside | (t[k] == e.t_min);
      else
        outside = outside | ((t[k] == e.t_min) & (t[k - 1] < e.t_min));
      if (k == 7)
        outside = outside | (t[k] == e.t_max);
      else
        outside = outside | ((t[k] == e.t_max) & (t[k + 1] > e.t_max));
      close_where(outside, top[k], bottom[k]);
    }

    // Where an edge meets an end's level, rounding leaves it a little beside.
    const F slack = F(1e-5F) * (xsimd::max(xsimd::max(e.Y[0], e.Y[1]), xsimd::max(e.Y[2], e.Y[3])) -
                                xsimd::min(xsimd::min(e.Y[0], e.Y[1]), xsimd::min(e.Y[2], e.Y[3])));
    const F unit = F(1.0F) / (per_mm * per_mm);
    const auto limits = footprint::front_facing(hx, hz, rim);
    const Mask dark = limits.lo >= limits.hi;
    F area = zero(), by_first = zero(), by_second = zero(), alone = zero();
    alignas(64) float is_first[kLanes], is_second[kLanes];
    const std::uint64_t used = n == 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << n) - 1;
    for (int k = 0; k < 7; ++k) {
      Piece p{t[k], t[k + 1], top[k], top[k + 1], bottom[k], bottom[k + 1]};
      const F length = p.t2 - p.t1, height1 = p.top1 - p.bottom1, height2 = p.top2 - p.bottom2;
      area += F(0.5F) * length * (height1 + height2);
      const Mask tall = (height1 > zero()) | (height2 > zero());
      const Mask bounded = height1 + height2 > slack;
      const F on_first = xsimd::select(bounded & (xsimd::max(p.bottom1, p.bottom2) <= first + slack), F(1.0F), zero());
      const F on_second = xsimd::select(bounded & (xsimd::min(p.top1, p.top2) >= second - slack), F(1.0F), zero());
      by_first -= on_first * length;
      by_second += on_second * length;
      alone -= (on_first - on_second) * length * F(0.5F) * (p.t1 + p.t2);
      store(is_first, on_first);
      store(is_second, on_second);
      const Mask nothing = clip(p, limits.lo, limits.hi) | dark | (!tall);
      Mask keep = !nothing;
      if constexpr (kMode == BatchMode::value)
        keep = keep & (p.t2 > p.t1);
      else
        keep = keep & ((p.t2 > p.t1) | ((p.top2 - p.bottom2) != (p.top1 - p.bottom1)));
      push_extra<kMode>(b, p, bits_of(keep) & used, in[8], in[9], in[10], in[11], is_first, is_second,
                        [&b, from](int k2) { return b.end_lane[from + k2]; });
    }

    alignas(64) float out[5][kLanes];
    const auto scatter = [&](const F& v, float* to) {
      store(out[0], v);
      for (int k = 0; k < n; ++k) to[b.end_lane[from + k]] = out[0][k];
    };
    scatter(unit * area, b.area);
    if constexpr (kMode != BatchMode::value) {
      const F height0 = top[0] - bottom[0], height7 = top[7] - bottom[7];
      scatter(unit * (height7 - height0), b.area_shift);
      scatter(unit * (alone - F(0.5F) * (height7 * (top[7] + bottom[7]) - height0 * (top[0] + bottom[0]))),
              b.area_turn);
      store(out[0], unit * by_first);
      store(out[1], unit * by_second);
      store(out[2], xsimd::select(dark, zero(), cut_turn(e, limits.lo, limits.hi, rim, first, second, hx, hy, hz)));
      for (int k = 0; k < n; ++k) {
        b.area_first[from + k] = out[0][k];
        b.area_second[from + k] = out[1][k];
        b.raw_turn[b.end_lane[from + k]] += out[2][k];
      }
      if constexpr (kMode == BatchMode::material) {
        const F rims = rim_light(hx, hy, hz, alpha, limits.lo, limits.hi, rim, height0, height7);
        scatter(xsimd::select(dark, zero(), rims), b.raw_rim);
        scatter(unit * (height0 + height7), b.area_rim);
      }
    }
  }

  /// Evaluates each pair's first piece, adds the others', and puts on the factors of the pair.
  template <BatchMode kMode>
  static void finish_packet(PairBatch& b, int i) {
    const Piece p{load(b.piece_t1 + i),   load(b.piece_t2 + i),      load(b.piece_top1 + i),
                  load(b.piece_top2 + i), load(b.piece_bottom1 + i), load(b.piece_bottom2 + i)};
    const F alpha = load(b.alpha + i), per_mm = load(b.per_mm + i);
    const Sums s = evaluate<kMode>(p, load(b.h_x + i), load(b.h_y + i), load(b.h_z + i), alpha);
    const F V = s.V + load(b.raw_V + i);
    const F one(1.0F), alpha2 = alpha * alpha, unit = F(0.318309886F) / (per_mm * per_mm);
    const F tan2_i = load(b.tan2_i + i), tan2_o = load(b.tan2_o + i);
    const F root_i = xsimd::sqrt(one + alpha2 * tan2_i), root_o = xsimd::sqrt(one + alpha2 * tan2_o);
    const F G = F(4.0F) / ((one + root_i) * (one + root_o));
    const F factor = unit * alpha2 * G;
    store(b.light + i, factor * V);
    if constexpr (kMode != BatchMode::value) {
      store(b.light_shift + i, factor * (s.shift + load(b.raw_shift + i)));
      store(b.light_turn + i, factor * (s.turn + load(b.raw_turn + i)));
      // For the pairs with ends, read back by place below.
      store(b.raw_first + i, factor * load(b.raw_first + i));
      store(b.raw_second + i, factor * load(b.raw_second + i));
    }
    if constexpr (kMode == BatchMode::material) {
      store(b.light_width + i, factor * (V + s.width + load(b.raw_width + i)));
      store(b.light_rim + i, factor * load(b.raw_rim + i));
      // d log G / d alpha, one wall at a time.
      const F dlogG = -(alpha * tan2_i / (root_i * (one + root_i)) + alpha * tan2_o / (root_o * (one + root_o)));
      const F radial = s.radial + load(b.raw_radial + i);
      store(b.light_alpha + i, factor * (V * (F(2.0F) / alpha + dlogG) - alpha * radial));
    }
  }

  template <BatchMode kMode>
  static void run(PairBatch& b) {
    b.extra_count = 0;
    b.end_count = 0;
    // A last packet that is not full repeats its first pair.
    const int padded = (b.count + kLanes - 1) / kLanes * kLanes;
    const auto pad = [&](float* lanes) {
      for (int i = b.count; i < padded; ++i) lanes[i] = lanes[b.count - 1];
    };
    for (int k = 0; k < 4; ++k) {
      pad(b.x[k]);
      pad(b.y[k]);
    }
    for (float* lanes : {b.h_x, b.h_y, b.h_z, b.tan2_i, b.tan2_o, b.across_x, b.across_y, b.per_mm, b.t_origin,
                         b.first_end, b.second_end, b.alpha, b.rim})
      pad(lanes);
    for (int i = 0; i < b.count; i += kLanes) cut_packet<kMode>(b, i);
    for (int i = 0; i < b.end_count; i += kLanes) cut_end_packet<kMode>(b, i);
    flush_extra<kMode>(b);
    for (int i = 0; i < b.count; i += kLanes) finish_packet<kMode>(b, i);
    if constexpr (kMode != BatchMode::value) {
      for (int k = 0; k < b.end_count; ++k) {
        b.light_first[k] = b.raw_first[b.end_lane[k]];
        b.light_second[k] = b.raw_second[b.end_lane[k]];
      }
    }
  }

  static void dispatch(PairBatch& b, BatchMode mode) {
    if (b.count == 0) {
      b.end_count = 0;
      return;
    }
    switch (mode) {
      case BatchMode::value:
        run<BatchMode::value>(b);
        break;
      case BatchMode::ends:
        run<BatchMode::ends>(b);
        break;
      case BatchMode::material:
        run<BatchMode::material>(b);
        break;
    }
  }
};

}  // namespace burin::batch

#undef BURIN_FLATTEN
