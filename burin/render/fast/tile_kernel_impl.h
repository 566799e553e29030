// burin/render/fast/tile_kernel_impl.h - the kernels of burin/render/fast/tile_kernel.h over a packet type. Included
// only by the files that are compiled for one instruction set each (see burin/render/fast/packet_math.h).
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "burin/render/fast/packet_math.h"
#include "burin/render/fast/tile_kernel.h"
#include "burin/render/fast/tile_raster.h"

namespace burin {

template <class P>
struct TileKernel {
  using F = P;
  using Mask = typename P::batch_bool_type;
  using Raster = TileRaster<P>;
  static constexpr int kLanes = kLanesOf<P>;

  static F load(const float* p) { return F::load_unaligned(p); }
  static void store(float* p, const F& v) { v.store_unaligned(p); }
  static F zero() { return F(0.0F); }
  static F inverse(const F& x) { return footprint::Arithmetic<P>::inverse(x); }

  /// A convex polygon's edges as lines over t: tops run towards smaller t, bottoms towards larger t.
  struct Edges {
    F t[4], Y[4], slope[4];
    Mask is_top[4], is_bottom[4];
    F t_min, t_max, Y_min, Y_max;

    void make() {
      // Counter-clockwise.
      const Mask clockwise = (t[2] - t[0]) * (Y[3] - Y[1]) < (t[3] - t[1]) * (Y[2] - Y[0]);
      for (F* v : {t, Y}) {
        const F one = v[1];
        v[1] = xsimd::select(clockwise, v[3], one);
        v[3] = xsimd::select(clockwise, one, v[3]);
      }
      for (int i = 0; i < 4; ++i) {
        const int j = (i + 1) % 4;
        const F dt = t[j] - t[i];
        is_top[i] = dt < zero();
        is_bottom[i] = dt > zero();
        slope[i] = (Y[j] - Y[i]) * inverse(xsimd::select(is_top[i] | is_bottom[i], dt, F(1.0F)));
      }
      t_min = xsimd::min(xsimd::min(t[0], t[1]), xsimd::min(t[2], t[3]));
      t_max = xsimd::max(xsimd::max(t[0], t[1]), xsimd::max(t[2], t[3]));
      Y_min = xsimd::min(xsimd::min(Y[0], Y[1]), xsimd::min(Y[2], Y[3]));
      Y_max = xsimd::max(xsimd::max(Y[0], Y[1]), xsimd::max(Y[2], Y[3]));
    }

    /// Cuts [bottom, top] to what the polygon has at t.
    void cut_levels(const F& at, F& top, F& bottom) const {
      for (int i = 0; i < 4; ++i) {
        const F line = Y[i] + slope[i] * (at - t[i]);
        top = xsimd::select(is_top[i], xsimd::min(top, line), top);
        bottom = xsimd::select(is_bottom[i], xsimd::max(bottom, line), bottom);
      }
    }

    /// Between which levels the polygon lies at t, cut to [first, second]; one level twice where it does not.
    void levels(const F& at, const F& first, const F& second, F& top, F& bottom) const {
      top = second;
      bottom = first;
      cut_levels(at, top, bottom);
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

  /// The part of a piece within [lo, hi]; says where nothing is left.
  static Mask clip(Piece& p, const F& lo, const F& hi) {
    const F ta = xsimd::max(p.t1, lo), tb = xsimd::min(p.t2, hi);
    const F length = p.t2 - p.t1;
    const F per_t = inverse(xsimd::select(length > zero(), length, F(1.0F)));
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

  /// What the pieces 0 .. count - 1 give, before the factors that are the same for all pieces of a pair. In two passes,
  /// one a lobe: a core looks only some hundred instructions ahead, and so it always has several packets in hand.
  template <KernelMode kMode>
  static void evaluate_pieces(TileRoom& b, int count) {
    constexpr footprint::Parts kParts = kMode == KernelMode::value  ? footprint::Parts::value
                                        : kMode == KernelMode::ends ? footprint::Parts::value_and_hx
                                                                    : footprint::Parts::all;
    for (int i = 0; i < count; i += kLanes) front_of_pieces<kParts>(b, i);
    for (int i = 0; i < count; i += kLanes) rest_of_pieces<kMode, kParts>(b, i);
  }

  template <footprint::Parts kParts>
  BURIN_FLATTEN static void front_of_pieces(TileRoom& b, int i) {
    const auto lobes = footprint::make_lobes(load(b.hx + i), load(b.hy + i), load(b.hz + i), load(b.piece_alpha + i));
    const auto m = footprint::front_lobe<kParts, true>(lobes, load(b.t1 + i), load(b.t2 + i));
    for (int k = 0; k < m.kParts; ++k) {
      store(b.front[2 * k] + i, m.part[k].m0);
      store(b.front[2 * k + 1] + i, m.part[k].m1);
    }
    if constexpr (kParts == footprint::Parts::all) return;
    const F* const kept[7] = {&lobes.e, &lobes.k, &lobes.p, &lobes.q, &lobes.s2, &lobes.inv_s, &lobes.r};
    for (int k = 0; k < 7; ++k) store(b.lobes[k] + i, *kept[k]);
  }

  /// As front_of_pieces() made them.
  template <footprint::Parts kParts>
  [[gnu::always_inline]] static footprint::Lobes<F> lobes_of_pieces(const TileRoom& b, int i) {
    if constexpr (kParts == footprint::Parts::all)
      return footprint::make_lobes(load(b.hx + i), load(b.hy + i), load(b.hz + i), load(b.piece_alpha + i));
    footprint::Lobes<F> lobes;
    F* const kept[7] = {&lobes.e, &lobes.k, &lobes.p, &lobes.q, &lobes.s2, &lobes.inv_s, &lobes.r};
    for (int k = 0; k < 7; ++k) *kept[k] = load(b.lobes[k] + i);
    lobes.s = lobes.s2 * lobes.inv_s;
    return lobes;
  }

  template <KernelMode kMode, footprint::Parts kParts>
  BURIN_FLATTEN static void rest_of_pieces(TileRoom& b, int i) {
    const F t1 = load(b.t1 + i), t2 = load(b.t2 + i), hx = load(b.hx + i), hy = load(b.hy + i), hz = load(b.hz + i);
    const auto lobes = lobes_of_pieces<kParts>(b, i);
    auto m = footprint::back_lobe<kParts, true>(lobes, t1, t2);
    for (int k = 0; k < m.kParts; ++k) {
      m.part[k].m0 = F(0.25F) * (m.part[k].m0 + load(b.front[2 * k] + i));
      m.part[k].m1 = F(0.25F) * (m.part[k].m1 + load(b.front[2 * k + 1] + i));
    }
    const F &m0 = m.part[0].m0, &m1 = m.part[0].m1;
    const F top1 = load(b.top1 + i), top2 = load(b.top2 + i), bottom1 = load(b.bottom1 + i),
            bottom2 = load(b.bottom2 + i);
    const F length = t2 - t1, half(0.5F);
    const F top = half * (top1 + top2), bottom = half * (bottom1 + bottom2);
    const F dtop = half * (top2 - top1), dbottom = half * (bottom2 - bottom1);
    const F height = top - bottom, rise = dtop - dbottom;
    store(b.piece_V + i, length * (height * m0 + rise * m1));
    if constexpr (kMode != KernelMode::value) {
      F by_hx;
      if constexpr (kMode == KernelMode::ends) {
        by_hx = length * (height * m.part[1].m0 + rise * m.part[1].m1);
      } else {
        const auto radial = footprint::detail::radial_over_r2<true>(lobes, m.part[2], t1, t2);
        const F by_radial = length * (height * radial.m0 + rise * radial.m1);
        by_hx = (hx * lobes.r2 * by_radial + hz * (length * (height * m.part[1].m0 + rise * m.part[1].m1))) / lobes.H2;
        store(b.piece_radial + i, by_radial);
        store(b.piece_width + i, F(2.0F) * rise * (half * (t1 + t2) * m0 + half * length * m1));
      }
      store(b.piece_shift + i, F(2.0F) * rise * m0);
      store(b.piece_turn + i,
            F(-2.0F) * ((top * dtop - bottom * dbottom) * m0 + (dtop * dtop - dbottom * dbottom) * m1) + hy * by_hx);
      store(b.piece_mean + i, length * m0);
      store(b.piece_first + i, length * (half * (t1 + t2) * m0 + half * length * m1));
    }
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

  /// G and what of alpha's derivative is in it: (alpha^2 / pi) G, and d log(alpha^2 G) / d alpha.
  struct Factor {
    F value, by_alpha;
  };
  template <KernelMode kMode>
  [[gnu::always_inline]] static Factor factor_of(const F& alpha, const F& tan2_i, const F& tan2_o) {
    const F one(1.0F), alpha2 = alpha * alpha;
    const F u = one + alpha2 * tan2_i, v = one + alpha2 * tan2_o;
    const F per_root_i = footprint::Arithmetic<P>::inverse_sqrt(u),
            per_root_o = footprint::Arithmetic<P>::inverse_sqrt(v);
    const F root_i = u * per_root_i, root_o = v * per_root_o;
    const F G = F(4.0F) * inverse((one + root_i) * (one + root_o));
    Factor f{F(0.318309886F) * alpha2 * G, zero()};
    if constexpr (kMode == KernelMode::material)
      f.by_alpha =
          F(2.0F) / alpha - alpha * (tan2_i * per_root_i / (one + root_i) + tan2_o * per_root_o / (one + root_o));
    return f;
  }

  /// Adds lanes 0 .. n - 1 of light and area to the pixels' sums.
  [[gnu::always_inline]] static void add_to_pixels(const F& light, const F& area, const std::uint16_t* place, int n,
                                                   float* sums) {
    alignas(64) float both[2 * kLanes];
    packet::interleave(light, area, both);
    using Two = float __attribute__((vector_size(8)));
    for (int k = 0; k < n; ++k) {
      Two sum, add;
      std::memcpy(&sum, sums + 2 * place[k], sizeof(Two));
      std::memcpy(&add, both + 2 * k, sizeof(Two));
      sum += add;
      std::memcpy(sums + 2 * place[k], &sum, sizeof(Two));
    }
  }

  /// The lines of the runs number(0) .. number(kLanes - 1), into column `at` and on. With `place`, a pixel for each of
  /// them: what the lines say of pixel (0, 0) is said of that pixel, and Y counts from kOriginY, which lies in it: Y
  /// keeps its digits where a scratch's end and a pixel's side nearly meet.
  template <class Number>
  BURIN_FLATTEN static void make_lines(const TileTask& task, const Number& number, float (*to)[TileRoom::kLines],
                                       int at, const std::uint16_t* place = nullptr) {
    F run[8], shape[4] = {F(task.shapes[0].per_mm), F(task.shapes[0].rim), F(task.shapes[0].alpha)};
    for (const int i : {0, 4}) packet::four_columns(run + i, [&](int k) { return &task.runs[number(k)].across_x + i; });
    if (!task.shapes.shared) packet::four_columns(shape, [&](int k) { return &task.shapes[number(k)].per_mm; });
    const TileLattice& lattice = *task.lattice;
    alignas(64) float in[9][kLanes], split[6][kLanes], Y[3][kLanes], origin[kLanes], pixel[2][kLanes];
    for (int i = 0; i < 8; ++i) run[i].store_aligned(in[i]);
    shape[0].store_aligned(in[8]);
    if (place != nullptr) {
      F column, row;
      packet::columns_and_rows(place, column, row);
      column.store_aligned(pixel[0]);
      row.store_aligned(pixel[1]);
    }
    using D = packet::DoublesOf<P>;
    for (int k = 0; k < kLanes; k += static_cast<int>(D::size)) {
      const auto get = [&](int i) { return packet::doubles<P>(in[i] + k); };
      const D per_mm = get(8), tx = per_mm * (get(0) + get(5)), ty = per_mm * (get(1) + get(6));
      D x(lattice.first_x), y(lattice.first_y);
      if (place != nullptr) {
        const D column = packet::doubles<P>(pixel[0] + k), row = packet::doubles<P>(pixel[1] + k);
        x += column * D(lattice.column_x) + row * D(lattice.row_x);
        y += column * D(lattice.column_y) + row * D(lattice.row_y);
      }
      const D t[3] = {tx * x + ty * y + (get(2) + get(7)), tx * D(lattice.column_x) + ty * D(lattice.column_y),
                      tx * D(lattice.row_x) + ty * D(lattice.row_y)};
      D mid_Y = tx * y - ty * x;
      if (place != nullptr) {
        packet::store_floats<P>(origin + k, mid_Y);
        mid_Y -= packet::doubles<P>(origin + k);
      }
      packet::store_floats<P>(Y[0] + k, mid_Y);
      packet::store_floats<P>(Y[1] + k, tx * D(lattice.column_y) - ty * D(lattice.column_x));
      packet::store_floats<P>(Y[2] + k, tx * D(lattice.row_y) - ty * D(lattice.row_x));
      // Added and taken away again, a large number leaves multiples of 2^-21 of the power of two in `size`.
      const D size = xsimd::abs(t[0]) + D(kTile) * (xsimd::abs(t[1]) + xsimd::abs(t[2]));
      const D exponent_bits(std::numeric_limits<double>::infinity());
      const D large = D(3.0 * (1 << 30)) * (size & exponent_bits);
      for (int i = 0; i < 3; ++i) {
        const D coarse = (t[i] + large) - large;
        packet::store_floats<P>(split[2 * i] + k, coarse);
        packet::store_floats<P>(split[2 * i + 1] + k, t[i] - coarse);
      }
    }
    const auto put = [&](Line line, const F& v) { store(to[line] + at, v); };
    const F column_coarse = F::load_aligned(split[2]), column_fine = F::load_aligned(split[3]);
    const F row_coarse = F::load_aligned(split[4]), row_fine = F::load_aligned(split[5]);
    put(kMidCoarse, F::load_aligned(split[0]));
    put(kMidFine, F::load_aligned(split[1]));
    put(kColumnCoarse, column_coarse);
    put(kColumnFine, column_fine);
    put(kRowCoarse, row_coarse);
    put(kRowFine, row_fine);
    const F column_Y = F::load_aligned(Y[1]), row_Y = F::load_aligned(Y[2]);
    put(kMidY, F::load_aligned(Y[0]));
    if (place != nullptr) put(kOriginY, F::load_aligned(origin));
    put(kColumnY, column_Y);
    put(kRowY, row_Y);
    // A pixel's sides, taken towards larger t.
    const F half(0.5F), column = column_coarse + column_fine, row_t = row_coarse + row_fine;
    const Mask column_back = column < zero(), row_back = row_t < zero();
    const F u = xsimd::abs(column), v = xsimd::abs(row_t);
    const F u_Y = xsimd::select(column_back, -column_Y, column_Y), v_Y = xsimd::select(row_back, -row_Y, row_Y);
    put(kReachCoarse, half * (xsimd::abs(column_coarse) + xsimd::abs(row_coarse)));
    put(kReachFine,
        half * (xsimd::select(column_back, -column_fine, column_fine) + xsimd::select(row_back, -row_fine, row_fine)));
    put(kReachY, half * (xsimd::abs(column_Y) + xsimd::abs(row_Y)));
    put(kFarY, half * (u_Y + v_Y));
    const F u_slope = u_Y * inverse(xsimd::max(u, F(1e-25F))), v_slope = v_Y * inverse(xsimd::max(v, F(1e-25F)));
    const Mask u_steeper = u_Y * v > v_Y * u;
    put(kSteep, xsimd::select(u_steeper, u_slope, v_slope));
    put(kFlat, xsimd::select(u_steeper, v_slope, u_slope));
    const F per_t = inverse(shape[0]);
    put(kUnit, per_t * per_t);
    put(kAcrossX, run[0]);
    put(kAcrossY, run[1]);
    put(kPerMm, shape[0]);
    put(kFirstEnd, run[3]);
    put(kSecondEnd, run[4]);
    put(kAlpha, shape[2]);
    put(kRim, shape[1]);
  }

  /// How a packet of pairs' pixels are lit and seen: the half vector and what `of` has beside it.
  struct Shading {
    F h_x, h_y, h_z, beside[2];

    [[gnu::always_inline]] Shading(const float (*of)[4], const std::uint16_t* place) {
      // To memory, whatever the compiler thinks: single lanes are slow to take out of a register.
      alignas(64) std::uint32_t at[kLanes];
      for (int k = 0; k < kLanes; ++k) at[k] = 4U * place[k];
      asm("" : "+m"(at));
      F shading[4];
      packet::four_columns(shading, [&](int k) { return of[0] + at[k]; });
      h_x = shading[0];
      h_y = shading[1];
      const F hz2 = xsimd::max(F(1.0F) - (h_x * h_x + h_y * h_y), F(1e-12F));
      h_z = hz2 * footprint::Arithmetic<P>::inverse_sqrt(hz2);
      beside[0] = shading[2];
      beside[1] = shading[3];
    }
  };

  /// How a packet of pairs' pixels are lit. Stores from `at` on: what light a pair sends for V = 1 and a unit of 1
  /// mm^2, the plain face's light a mm^2 there, and d log(alpha^2 G) / d alpha.
  template <KernelMode kMode>
  [[gnu::always_inline]] static Shading shade(const TileTask& task, TileRoom& room, const std::uint16_t* place,
                                              const F& alpha, int at) {
    const bool one_alpha = task.shapes.shared;
    const Shading px(one_alpha ? room.lit : task.shading->at, place);
    Factor f{px.beside[0], zero()};
    F base = px.beside[1];
    if (one_alpha) {
      if constexpr (kMode == KernelMode::material) f.by_alpha = packet::look_up<P>(room.lit_by_alpha, place);
    } else {
      f = factor_of<kMode>(alpha, px.beside[0], px.beside[1]);
      if constexpr (kMode != KernelMode::value) base = packet::look_up<P>(task.base, place);
    }
    store(room.gain + at, f.value);
    if constexpr (kMode != KernelMode::value) store(room.base + at, base);
    if constexpr (kMode == KernelMode::material) store(room.by_alpha + at, f.by_alpha);
    return px;
  }

  /// Fills room.lit and room.lit_by_alpha.
  template <KernelMode kMode>
  BURIN_FLATTEN static void shade_tile(const TileTask& task, TileRoom& room) {
    const F alpha(task.shapes[0].alpha);
    for (int i = 0; i < kTilePixels; i += kLanes) {
      F of[4];
      packet::four_columns(of, [&](int k) { return task.shading->at[i + k]; });
      const Factor f = factor_of<kMode>(alpha, of[2], of[3]);
      const F base = kMode == KernelMode::value ? zero() : load(task.base + i);
      packet::four_rows({of[0], of[1], f.value, base}, room.lit + i);
      if constexpr (kMode == KernelMode::material) store(room.lit_by_alpha + i, f.by_alpha);
    }
  }

  /// Where the middles of a packet of pairs' pixels would be on the lattice, in the scratches' own units.
  struct Middle {
    F coarse, fine, Y;
  };
  template <class Constant>
  [[gnu::always_inline]] static Middle middle_of(const std::uint16_t* place, const Constant& of) {
    F column, row;
    packet::columns_and_rows(place, column, row);
    return {of(kMidCoarse) + column * of(kColumnCoarse) + row * of(kRowCoarse),
            of(kMidFine) + column * of(kColumnFine) + row * of(kRowFine),
            of(kMidY) + column * of(kColumnY) + row * of(kRowY)};
  }

  /// The pixels' corners in their scratches' own units. of(Line) is a constant of the scratches.
  template <class Constant>
  [[gnu::always_inline]] static Edges edges_of(const TileTask& task, const std::uint16_t* place, const Middle& middle,
                                               const Constant& of) {
    Edges e;
    const F half(0.5F);
    constexpr float kColumn[4] = {-1, 1, 1, -1}, kRow[4] = {-1, -1, 1, 1};
    F fine[4];
    for (int k = 0; k < 4; ++k) {
      const F column = half * F(kColumn[k]), row = half * F(kRow[k]);
      e.t[k] = middle.coarse + (column * of(kColumnCoarse) + row * of(kRowCoarse));
      fine[k] = middle.fine + (column * of(kColumnFine) + row * of(kRowFine));
      e.Y[k] = middle.Y + (column * of(kColumnY) + row * of(kRowY));
    }
    if (task.corners != nullptr) {
      // In floats from the first: rows of corners are one longer than rows of pixels.
      static_assert(TileCorners::kSide == kTile + 1);
      alignas(64) std::uint32_t at[kLanes];
      for (int k = 0; k < kLanes; ++k) at[k] = 2U * (place[k] + place[k] / kTile);
      asm("" : "+m"(at));  // as above
      const float *corners = task.corners->at[0], *below = corners + 2 * TileCorners::kSide;
      F up[4], down[4];
      packet::four_columns(up, [&](int k) { return corners + at[k]; });
      packet::four_columns(down, [&](int k) { return below + at[k]; });
      const F tx = of(kAcrossX) * of(kPerMm), ty = of(kAcrossY) * of(kPerMm);
      const auto move = [&](int k, const F& x, const F& y) {
        fine[k] += tx * x + ty * y;
        e.Y[k] += tx * y - ty * x;
      };
      move(0, up[0], up[1]);
      move(1, up[2], up[3]);
      move(2, down[2], down[3]);
      move(3, down[0], down[1]);
    }
    for (int k = 0; k < 4; ++k) e.t[k] += fine[k];
    e.make();
    return e;
  }

  /// What of a packet of pixels lies across their grooves, before the scratches' ends.
  struct Crossing {
    F t_min, t_max, Y_min, Y_max;
    F a, b;  // the groove reaches over [a, b] of the pixel
    F top1, top2, bottom1, bottom2;
    F inside;    // above 0 where a corner lies between a and b
    Mask along;  // a side runs along the groove
  };

  template <class Constant>
  [[gnu::always_inline]] static Crossing crossing_of_corners(const TileTask& task, const std::uint16_t* place,
                                                             const Constant& of) {
    const Edges e = edges_of(task, place, middle_of(place, of), of);
    const F rim = of(kRim), a = xsimd::max(-rim, e.t_min), b = xsimd::min(rim, e.t_max);
    F top1(1e30F), top2(1e30F), bottom1(-1e30F), bottom2(-1e30F);
    e.cut_levels(a, top1, bottom1);
    e.cut_levels(b, top2, bottom2);
    F inside = (e.t[0] - a) * (b - e.t[0]);
    Mask slanting = e.is_top[0] | e.is_bottom[0];
    for (int k = 1; k < 4; ++k) {
      inside = xsimd::max(inside, (e.t[k] - a) * (b - e.t[k]));
      slanting = slanting & (e.is_top[k] | e.is_bottom[k]);
    }
    return {e.t_min, e.t_max, e.Y_min, e.Y_max, a, b, top1, top2, bottom1, bottom2, inside, !slanting};
  }

  /// The same where all corners lie on the lattice: pixels are parallelograms, whose sides the constants hold. From the
  /// corner with the least t the steeper side goes up and then the flatter one, below it the other way round.
  template <class Constant>
  [[gnu::always_inline]] static Crossing crossing_on_lattice(const std::uint16_t* place, const Constant& of) {
    const Middle middle = middle_of(place, of);
    Crossing c;
    c.t_min = (middle.coarse - of(kReachCoarse)) + (middle.fine - of(kReachFine));
    c.t_max = (middle.coarse + of(kReachCoarse)) + (middle.fine + of(kReachFine));
    c.Y_min = middle.Y - of(kReachY);
    c.Y_max = middle.Y + of(kReachY);
    const F rim = of(kRim);
    c.a = xsimd::max(-rim, c.t_min);
    c.b = xsimd::min(rim, c.t_max);
    const F near_Y = middle.Y - of(kFarY), far_Y = middle.Y + of(kFarY), steep = of(kSteep), flat = of(kFlat);
    const auto levels = [&](const F& at, F& top, F& bottom) {
      const F from_near = at - c.t_min, from_far = at - c.t_max;
      top = xsimd::min(near_Y + steep * from_near, far_Y + flat * from_far);
      bottom = xsimd::max(near_Y + flat * from_near, far_Y + steep * from_far);
    };
    levels(c.a, c.top1, c.bottom1);
    levels(c.b, c.top2, c.bottom2);
    const F column = xsimd::abs(of(kColumnCoarse) + of(kColumnFine)), row = xsimd::abs(of(kRowCoarse) + of(kRowFine));
    const F t1 = c.t_min + column, t2 = c.t_min + row;
    c.inside = xsimd::max((t1 - c.a) * (c.b - t1), (t2 - c.a) * (c.b - t2));
    // So nearly along it that its corners may round to the same t.
    c.along = xsimd::min(column, row) < F(1e-6F);
    return c;
  }

  /// Pairs that are not to be finished at once, as bits of the lanes.
  struct Aside {
    std::uint32_t corners, ends;
  };

  /// One packet of pairs whose pixels the groove crosses from side to side, or enters with an end square across it: a
  /// piece each, at `at`. The others become empty pieces: those to be set aside, and those that the groove does not
  /// meet at all.
  template <KernelMode kMode, bool kOnLattice>
  BURIN_FLATTEN static Aside cross(const TileTask& task, const TilePlaces& places, TileRoom& room,
                                   const std::uint32_t* line, std::size_t pair, int at) {
    const std::uint16_t* place = &places.place[pair];
    const packet::Picker<P> pick(line);
    const auto constant = [&](Line c) { return pick(room.line[c]); };
    Crossing e;
    if constexpr (kOnLattice)
      e = crossing_on_lattice(place, constant);
    else
      e = crossing_of_corners(task, place, constant);
    const F alpha = constant(kAlpha);
    const Shading px = shade<kMode>(task, room, place, alpha, at);
    const F across_x = constant(kAcrossX), across_y = constant(kAcrossY);
    const F first = constant(kFirstEnd), second = constant(kSecondEnd), rim = constant(kRim);
    const F hx = across_x * px.h_x + across_y * px.h_y, hy = across_x * px.h_y - across_y * px.h_x, hz = px.h_z;
    const Mask apart = (e.t_min >= rim) | (e.t_max <= -rim) | (e.Y_min >= second) | (e.Y_max <= first);
    // At both ends of [a, b]: the pixel's edges, and whether one of the scratch's ends lies before them.
    const F &a = e.a, &b = e.b;
    F top1 = e.top1, top2 = e.top2, bottom1 = e.bottom1, bottom2 = e.bottom2;
    const Mask capped1 = top1 > second, capped2 = top2 > second, raised1 = bottom1 < first, raised2 = bottom2 < first;
    top1 = xsimd::min(top1, second);
    top2 = xsimd::min(top2, second);
    bottom1 = xsimd::max(bottom1, first);
    bottom2 = xsimd::max(bottom2, first);
    const Mask closed1 = top1 < bottom1, closed2 = top2 < bottom2;
    const Mask mixed = (capped1 != capped2) | (raised1 != raised2) | (closed1 != closed2);
    // An end that lies in the pixel from a to b, or beside it, bounds a single piece as an edge does. So does a corner
    // at a or b, unless one of the pixel's edges runs along the groove there.
    const Mask has_corner = b - a < rim + rim;
    const Mask corner_between = (e.inside > zero()) | (e.along & has_corner);
    const Mask in_reach = ((e.Y_min < first) | (e.Y_max > second)) & !apart;
    const Mask ends = in_reach & (corner_between | mixed);
    const Mask corners = corner_between & !(apart | in_reach);
    const Mask none = apart | ends | corners | (closed1 & closed2);
    close_where(closed1, top1, bottom1);
    close_where(closed2, top2, bottom2);
    const F height1 = top1 - bottom1, height2 = top2 - bottom2;
    const F unit = xsimd::select(none, zero(), constant(kUnit));
    // Where n.h > 0, between lo and hi: on a deep groove one wall is often partly turned away.
    const auto limits = footprint::front_facing(hx, hz, rim);
    const F lo = xsimd::max(limits.lo, a), hi = xsimd::min(limits.hi, b);
    const Mask dark = none | (lo >= hi);
    const F length = b - a, per_length = inverse(length), at_lo = (lo - a) * per_length, at_hi = (hi - a) * per_length;
    const F dtop = top2 - top1, dbottom = bottom2 - bottom1;
    const Piece p{
        lo, hi, top1 + at_lo * dtop, top1 + at_hi * dtop, bottom1 + at_lo * dbottom, bottom1 + at_hi * dbottom};
    const auto keep = [&](float* to, const F& v) { store(to + at, xsimd::select(dark, zero(), v)); };
    // Empty pieces are as long as their neighbors, but without height: short ones would be worked out in another way.
    const Mask away = limits.lo >= limits.hi;
    store(room.t1 + at, xsimd::select(dark, xsimd::select(away, zero(), limits.lo), p.t1));
    store(room.t2 + at, xsimd::select(dark, xsimd::select(away, zero(), limits.hi), p.t2));
    keep(room.top1, p.top1);
    keep(room.top2, p.top2);
    keep(room.bottom1, p.bottom1);
    keep(room.bottom2, p.bottom2);
    store(room.hx + at, hx);
    store(room.hy + at, hy);
    store(room.hz + at, hz);
    store(room.piece_alpha + at, alpha);
    store(room.unit + at, unit);
    store(room.area + at, F(0.5F) * unit * length * (height1 + height2));
    if constexpr (kMode != KernelMode::value) {
      // The limit moves as h turns (W is 1 there).
      const F per_H = footprint::Arithmetic<P>::inverse_sqrt(hx * hx + hz * hz);
      const F moving = xsimd::select(lo > a, (p.top1 - p.bottom1) * lo, zero()) +
                       xsimd::select(hi < b, (p.top2 - p.bottom2) * hi, zero());
      keep(room.moving_turn, -(hy * per_H * moving));
      store(&room.area_shift[pair], unit * (height2 - height1));
      const F on_first = xsimd::select(raised1 & !none, F(1.0F), zero()),
              on_second = xsimd::select(capped1 & !none, F(1.0F), zero());
      // An edge opposite an end turns alone.
      const F alone = (on_second - on_first) * length * (a + b);
      store(&room.area_turn[pair], F(0.5F) * unit * (alone + height1 * (top1 + bottom1) - height2 * (top2 + bottom2)));
      store(room.on_first + at, on_first);
      store(room.on_second + at, on_second);
      store(room.a_first + at, unit * length);
    }
    if constexpr (kMode == KernelMode::material) {
      const F area_rim = unit * (height1 + height2);
      store(&room.area_rim[pair], area_rim);
      store(&room.area_width[pair], rim * area_rim);
      keep(room.rim_light, rim_light(hx, hy, hz, alpha, lo, hi, rim, height1, height2));
    }
    return {packet::bits_of<P>(corners), packet::bits_of<P>(ends)};
  }

  /// The factors of one packet of pairs that cross() began, and their places. `line`: as in TileRoom.
  template <KernelMode kMode>
  BURIN_FLATTEN static void finish_crossing(const TileTask& task, const TilePlaces& places, TileRoom& room,
                                            TilePairs& pairs, const TileJacobian& to, const std::uint32_t* line,
                                            std::size_t pair, int at, int lanes) {
    const F gain = load(room.unit + at) * load(room.gain + at), V = load(room.piece_V + at), light = gain * V;
    if (task.keep_light) store(&pairs.light[pair], light);
    if constexpr (kMode != KernelMode::value) {
      const F base = load(room.base + at), first = load(room.on_first + at), second = load(room.on_second + at);
      // An edge opposite an end turns alone (between two edges this part cancels).
      const F turn = load(room.piece_turn + at) - (first - second) * load(room.piece_first + at);
      store(to.shift + pair, gain * load(room.piece_shift + at) - base * load(&room.area_shift[pair]));
      store(to.turn + pair, gain * (turn + load(room.moving_turn + at)) - base * load(&room.area_turn[pair]));
      const std::uint32_t used = lanes < kLanes ? (1U << lanes) - 1 : ~0U;
      std::uint32_t bits = packet::bits_of<P>(first + second > zero()) & used;
      if (bits != 0) {
        const F area = load(room.a_first + at), both = gain * load(room.piece_mean + at) - base * area;
        alignas(64) float out[4][kLanes];
        (-first * both).store_aligned(out[0]);
        (second * both).store_aligned(out[1]);
        (-first * area).store_aligned(out[2]);
        (second * area).store_aligned(out[3]);
        for (; bits != 0; bits &= bits - 1) {
          const int k = std::countr_zero(bits);
          pairs.ends.push_back(
              {static_cast<std::uint32_t>(pair + k), room.live[line[k]], out[0][k], out[1][k], out[2][k], out[3][k]});
        }
      }
      if constexpr (kMode == KernelMode::material) {
        const F alpha = load(room.piece_alpha + at);
        store(to.width + pair, gain * (V + load(room.piece_width + at)) - base * load(&room.area_width[pair]));
        store(to.rim + pair, gain * load(room.rim_light + at) - base * load(&room.area_rim[pair]));
        store(to.alpha + pair, gain * (V * load(room.by_alpha + at) - alpha * load(room.piece_radial + at)));
      }
    }
    add_to_pixels(light, load(room.area + at), &places.place[pair], lanes, room.sums);
  }

  /// Evaluates the pieces that cut() made and adds what they give to their pairs.
  template <KernelMode kMode, bool kEnds>
  BURIN_FLATTEN static void add_pieces(TileRoom& b) {
    // Harmless pieces up to a full packet.
    for (int i = b.piece_count; i < b.piece_count + kLanes; ++i) {
      b.t1[i] = b.t2[i] = b.top1[i] = b.top2[i] = b.bottom1[i] = b.bottom2[i] = b.hx[i] = b.hy[i] = 0;
      b.hz[i] = 1;
      b.piece_alpha[i] = 0.5F;
    }
    evaluate_pieces<kMode>(b, b.piece_count);
    using Four = float __attribute__((vector_size(16)));
    for (int i = 0; i < b.piece_count; i += kLanes) {
      const int n = std::min(kLanes, b.piece_count - i);
      const std::uint16_t* owner = b.piece_owner + i;
      alignas(64) float rows[kLanes][4];
      const auto add = [&](const F(&columns)[4], int at) {
        packet::four_rows(columns, rows);
        for (int k = 0; k < n; ++k) {
          Four sum, more;
          std::memcpy(&sum, b.total[owner[k]] + at, sizeof(Four));
          std::memcpy(&more, rows[k], sizeof(Four));
          sum += more;
          std::memcpy(b.total[owner[k]] + at, &sum, sizeof(Four));
        }
      };
      if constexpr (kMode == KernelMode::value) {
        for (int k = 0; k < n; ++k) b.total[owner[k]][0] += b.piece_V[i + k];
        continue;
      }
      F turn = load(b.piece_turn + i), by_first = zero(), by_second = zero(), width = zero(), radial = zero();
      if constexpr (kEnds) {
        const F first = load(b.on_first + i), second = load(b.on_second + i), mean = load(b.piece_mean + i);
        // An edge opposite an end turns alone (between two edges this part cancels).
        turn -= (first - second) * load(b.piece_first + i);
        by_first = -first * mean;
        by_second = second * mean;
      }
      if constexpr (kMode == KernelMode::material) {
        width = load(b.piece_width + i);
        radial = load(b.piece_radial + i);
      }
      add({load(b.piece_V + i), load(b.piece_shift + i), turn, width}, 0);
      if constexpr (kEnds || kMode == KernelMode::material) add({by_first, by_second, radial, zero()}, 4);
    }
    b.piece_count = 0;
  }

  /// Cuts one packet of pairs at the pixels' corners and, with kEnds, at where their edges meet the scratch's ends: up
  /// to three or seven pieces each. `from`: the packet's place in the group.
  template <KernelMode kMode, bool kEnds>
  BURIN_FLATTEN static void cut(const TileTask& task, TileRoom& b, const TilePlaces& places, const std::uint32_t* pair,
                                const std::uint32_t* line, int from, int lanes) {
    alignas(64) std::uint16_t place[kLanes];
    for (int k = 0; k < kLanes; ++k) place[k] = places.place[pair[std::min(k, lanes - 1)]];
    make_lines(
        task, [&](int k) { return b.live[line[std::min(k, lanes - 1)]]; }, b.line, 0, place);
    const auto constant = [&](Line c) { return load(b.line[c]); };
    const Edges e = edges_of(task, place, Middle{constant(kMidCoarse), constant(kMidFine), constant(kMidY)}, constant);
    const F origin_Y = constant(kOriginY), first = constant(kFirstEnd) - origin_Y,
            second = constant(kSecondEnd) - origin_Y, alpha = constant(kAlpha), rim = constant(kRim);
    const Shading px = shade<kMode>(task, b, place, alpha, from);
    const F across_x = constant(kAcrossX), across_y = constant(kAcrossY);
    const F hx = across_x * px.h_x + across_y * px.h_y, hy = across_x * px.h_y - across_y * px.h_x, hz = px.h_z;
    constexpr int kBreaks = kEnds ? 8 : 4;
    F t[kBreaks] = {e.t[0], e.t[1], e.t[2], e.t[3]};
    if constexpr (kEnds) {
      for (int k = 4; k < 8; ++k) t[k] = k % 2 == 0 ? rim : -rim;
      for (int k = 0; k < 4; ++k) {
        const int j = (k + 1) % 4;
        const F dY = e.Y[j] - e.Y[k];
        const F per_Y = (e.t[j] - e.t[k]) * inverse(xsimd::select(dY == zero(), F(1.0F), dY));
        for (int end = 0; end < 2; ++end) {
          const F& level = end == 0 ? first : second;
          const Mask crosses = ((e.Y[k] < level) & (e.Y[j] >= level)) | ((e.Y[j] < level) & (e.Y[k] >= level));
          const F at = e.t[k] + (level - e.Y[k]) * per_Y;
          t[4 + 2 * end] = xsimd::select(crosses, xsimd::min(t[4 + 2 * end], at), t[4 + 2 * end]);
          t[5 + 2 * end] = xsimd::select(crosses, xsimd::max(t[5 + 2 * end], at), t[5 + 2 * end]);
        }
      }
    }
    for (F& v : t) v = xsimd::min(xsimd::max(v, -rim), rim);
    // Batcher's networks for eight and for four.
    constexpr int kNetwork[19][2] = {{0, 1}, {2, 3}, {4, 5}, {6, 7}, {0, 2}, {1, 3}, {4, 6}, {5, 7}, {1, 2}, {5, 6},
                                     {0, 4}, {1, 5}, {2, 6}, {3, 7}, {2, 4}, {3, 5}, {1, 2}, {3, 4}, {5, 6}};
    constexpr int kNetworkOf4[5][2] = {{0, 1}, {2, 3}, {0, 2}, {1, 3}, {1, 2}};
    if constexpr (kEnds)
#pragma GCC unroll 19
      for (const auto& c : kNetwork) order(t[c[0]], t[c[1]]);
    else
#pragma GCC unroll 5
      for (const auto& c : kNetworkOf4) order(t[c[0]], t[c[1]]);

    F top[kBreaks], bottom[kBreaks];
#pragma GCC unroll 8
    for (int k = 0; k < kBreaks; ++k) {
      e.levels(t[k], first, second, top[k], bottom[k]);
      // The outermost corners have no height, nor has the first breakpoint on them; an edge along the groove there is a
      // piece without length but with a rise.
      Mask outside = (t[k] < e.t_min) | (t[k] > e.t_max);
      if (k == 0)
        outside = outside | (t[k] == e.t_min);
      else
        outside = outside | ((t[k] == e.t_min) & (t[k - 1] < e.t_min));
      if (k == kBreaks - 1)
        outside = outside | (t[k] == e.t_max);
      else
        outside = outside | ((t[k] == e.t_max) & (t[k + 1] > e.t_max));
      close_where(outside, top[k], bottom[k]);
    }

    const F unit = constant(kUnit);
    const auto limits = footprint::front_facing(hx, hz, rim);
    const Mask dark = limits.lo >= limits.hi;
    const bool any_cut = xsimd::any((limits.lo > -rim) | (limits.hi < rim));
    const std::uint32_t used = lanes == 32 ? ~0U : (1U << lanes) - 1;
    F area = zero(), by_first = zero(), by_second = zero(), alone = zero();
#pragma GCC unroll 7
    for (int k = 0; k + 1 < kBreaks; ++k) {
      Piece p{t[k], t[k + 1], top[k], top[k + 1], bottom[k], bottom[k + 1]};
      const F length = p.t2 - p.t1, height1 = p.top1 - p.bottom1, height2 = p.top2 - p.bottom2;
      area += F(0.5F) * length * (height1 + height2);
      const Mask tall = (height1 > zero()) | (height2 > zero());
      F on_first = zero(), on_second = zero();
      if constexpr (kEnds) {
        // An end bounds a piece where it lies between the pixel's edges. Where an edge meets it is a breakpoint, near
        // which rounding leaves the edge a little beside it, much where the edge is steep: so ask in the middle.
        const F middle = F(0.5F) * (p.t1 + p.t2);
        F upper(1e30F), lower(-1e30F);
        e.cut_levels(middle, upper, lower);
        const Mask within = (middle > e.t_min) & (middle < e.t_max);
        on_first = xsimd::select(within & (lower < first) & (upper > first), F(1.0F), zero());
        on_second = xsimd::select(within & (lower < second) & (upper > second), F(1.0F), zero());
        by_first -= on_first * length;
        by_second += on_second * length;
        alone -= (on_first - on_second) * length * F(0.5F) * (p.t1 + p.t2);
      }
      Mask nothing = dark | !tall;
      if (any_cut) nothing = nothing | clip(p, limits.lo, limits.hi);
      Mask keep = !nothing;
      if constexpr (kMode == KernelMode::value)
        keep = keep & (p.t2 > p.t1);
      else
        keep = keep & ((p.t2 > p.t1) | ((p.top2 - p.bottom2) != (p.top1 - p.bottom1)));
      const std::uint32_t bits = packet::bits_of<P>(keep) & used;
      if (bits == 0) continue;
      const int n = b.piece_count;
      packet::pack(b.t1 + n, p.t1, bits);
      packet::pack(b.t2 + n, p.t2, bits);
      packet::pack(b.top1 + n, p.top1, bits);
      packet::pack(b.top2 + n, p.top2, bits);
      packet::pack(b.bottom1 + n, p.bottom1, bits);
      packet::pack(b.bottom2 + n, p.bottom2, bits);
      packet::pack(b.hx + n, hx, bits);
      packet::pack(b.hy + n, hy, bits);
      packet::pack(b.hz + n, hz, bits);
      packet::pack(b.piece_alpha + n, alpha, bits);
      if constexpr (kMode != KernelMode::value) {
        packet::pack(b.on_first + n, on_first, bits);
        packet::pack(b.on_second + n, on_second, bits);
      }
      for (std::uint32_t left = bits; left != 0; left &= left - 1)
        b.piece_owner[b.piece_count++] = static_cast<std::uint16_t>(from + std::countr_zero(left));
    }

    store(b.area + from, unit * area);
    store(b.alpha + from, alpha);
    store(b.unit + from, unit);
    if constexpr (kMode != KernelMode::value) {
      constexpr int kLast = kBreaks - 1;
      const F height0 = top[0] - bottom[0], height1 = top[kLast] - bottom[kLast];
      const F shift = height1 - height0;
      store(b.origin_Y + from, origin_Y);
      store(b.a_shift + from, unit * shift);
      store(b.a_turn + from,
            unit * (alone - F(0.5F) * (height1 * (top[kLast] + bottom[kLast]) - height0 * (top[0] + bottom[0])) -
                    origin_Y * shift));
      store(b.a_first + from, unit * by_first);
      store(b.a_second + from, unit * by_second);
      F turn = zero();
      if (any_cut)
        turn = xsimd::select(dark, zero(), cut_turn(e, limits.lo, limits.hi, rim, first, second, hx, hy, hz));
      store(b.moving_turn + from, turn);
      if constexpr (kMode == KernelMode::material) {
        const F rims = rim_light(hx, hy, hz, alpha, limits.lo, limits.hi, rim, height0, height1);
        store(b.rim_light + from, xsimd::select(dark, zero(), rims));
        store(b.a_rim + from, unit * (height0 + height1));
        store(b.rim + from, rim);
      }
    }
  }

  /// Pairs set aside, a group at a time: cut, their pieces evaluated, and put in their places.
  template <KernelMode kMode, bool kEnds>
  static void finish_specials(const TileTask& task, const TilePlaces& places, TileRoom& b,
                              const TileRoom::Special& special, TilePairs& pairs, const TileJacobian& to) {
    constexpr std::size_t kGroup = TileRoom::kPieces / (kEnds ? 8 : 4);
    static_assert(kGroup <= TileRoom::kChunk);
    const std::size_t count = special.count;
    for (std::size_t group = 0; group < count; group += kGroup) {
      const int n = static_cast<int>(std::min(kGroup, count - group));
      const std::uint32_t *pair = &special.pair[group], *line = &special.line[group];
      b.piece_count = 0;
      std::memset(b.total, 0, (n + kLanes) * sizeof(b.total[0]));
      for (int i = 0; i < n; i += kLanes)
        cut<kMode, kEnds>(task, b, places, pair + i, line + i, i, std::min(kLanes, n - i));
      add_pieces<kMode, kEnds>(b);
      for (int i = 0; i < n; i += kLanes)
        finish<kMode, kEnds>(task, places, b, pairs, to, pair + i, line + i, i, std::min(kLanes, n - i));
    }
  }

  template <KernelMode kMode, bool kEnds>
  BURIN_FLATTEN static void finish(const TileTask& task, const TilePlaces& places, TileRoom& b, TilePairs& pairs,
                                   const TileJacobian& to, const std::uint32_t* pair, const std::uint32_t* line, int i,
                                   int lanes) {
    const F gain = load(b.unit + i) * load(b.gain + i);
    F total[8];
    packet::four_columns(total, [&](int k) { return b.total[i + k]; });
    if constexpr (kEnds || kMode == KernelMode::material)
      packet::four_columns(total + 4, [&](int k) { return b.total[i + k] + 4; });
    const F &V = total[0], light = gain * V;
    alignas(64) float out[kLanes];
    const auto scatter = [&](float* array, const F& v) {
      v.store_aligned(out);
      for (int k = 0; k < lanes; ++k) array[pair[k]] = out[k];
    };
    std::uint16_t place[kLanes] = {};
    for (int k = 0; k < lanes; ++k) place[k] = places.place[pair[k]];
    add_to_pixels(light, load(b.area + i), place, lanes, b.sums);
    if (task.keep_light) scatter(pairs.light.data(), light);
    if constexpr (kMode != KernelMode::value) {
      const F base = load(b.base + i), area_shift = load(b.a_shift + i), area_turn = load(b.a_turn + i);
      scatter(to.shift, gain * total[1] - base * area_shift);
      const F turn = total[2] - load(b.origin_Y + i) * total[1];
      scatter(to.turn, gain * (turn + load(b.moving_turn + i)) - base * area_turn);
      scatter(b.area_shift.data(), area_shift);
      scatter(b.area_turn.data(), area_turn);
      if constexpr (kEnds) {
        alignas(64) float first[kLanes], second[kLanes];
        (gain * total[4] - base * load(b.a_first + i)).store_aligned(first);
        (gain * total[5] - base * load(b.a_second + i)).store_aligned(second);
        for (int k = 0; k < lanes; ++k)
          pairs.ends.push_back({pair[k], b.live[line[k]], first[k], second[k], b.a_first[i + k], b.a_second[i + k]});
      }
      if constexpr (kMode == KernelMode::material) {
        const F area_rim = load(b.a_rim + i), area_width = load(b.rim + i) * area_rim, alpha = load(b.alpha + i);
        scatter(b.area_rim.data(), area_rim);
        scatter(b.area_width.data(), area_width);
        scatter(to.width, gain * (V + total[3]) - base * area_width);
        scatter(to.rim, gain * load(b.rim_light + i) - base * area_rim);
        scatter(to.alpha, gain * (V * load(b.by_alpha + i) - alpha * total[6]));
      }
    }
  }

  static void find(const TileTask& task, FoundPlaces& found) {
    Raster::grow(found.begin, task.most_runs);
    Raster::grow(found.place, task.most_pairs + kTilePixels + 48);
    Raster::find(task.blocks, task.runs, task.shapes, task.run_count, task.valid_rows, found.begin, found.place);
  }

  template <KernelMode kMode>
  static void evaluate_mode(const TileTask& task, const TilePlaces& places, TileRoom& room, TilePairs& pairs,
                            const TileJacobian& to) {
    const std::size_t count = places.begin[task.run_count];
    const std::size_t most = std::max(count, task.most_pairs);
    if (task.keep_light) Raster::grow(pairs.light, most);
    if constexpr (kMode != KernelMode::value)
      for (std::vector<float>* v : {&room.area_shift, &room.area_turn}) Raster::grow(*v, most);
    if constexpr (kMode == KernelMode::material)
      for (std::vector<float>* v : {&room.area_width, &room.area_rim}) Raster::grow(*v, most);
    for (TileRoom::Special* special : {&room.corners, &room.ends})
      for (std::vector<std::uint32_t>* v : {&special->pair, &special->line}) Raster::grow(*v, most + TileRoom::kChunk);
    if (pairs.ends.capacity() < most) pairs.ends.reserve(16 * most);
    std::fill(std::begin(room.sums), std::end(room.sums), 0.0F);
    pairs.ends.clear();
    room.corners.count = room.ends.count = 0;

    if (task.shapes.shared) shade_tile<kMode>(task, room);
    list_live_runs(task, places, count, room);
    // One chunk ahead: what was stored just now cannot be loaded at once.
    std::uint32_t line = ~0U, made = 0;
    const auto number_chunk = [&](std::size_t chunk) {
      if (chunk < count) number_lines(&room.starts[chunk / 8], line, room.line_of[chunk / TileRoom::kChunk % 2]);
    };
    number_chunk(0);
    for (std::size_t chunk = 0; chunk < count; chunk += TileRoom::kChunk) {
      number_chunk(chunk + TileRoom::kChunk);
      const std::uint32_t* line_of = room.line_of[chunk / TileRoom::kChunk % 2];
      const int n = static_cast<int>(std::min<std::size_t>(TileRoom::kChunk, count - chunk));
      for (int i = 0; i < n; i += kLanes) {
        for (; made <= line_of[i + kLanes - 1]; made += kLanes) {
          // Those of the packet after the next: runs come from far away.
          const auto* ahead = reinterpret_cast<const char*>(&task.runs[room.live[made]] + 2 * kLanes);
          for (std::size_t byte = 0; byte < kLanes * sizeof(TileRun); byte += 64) __builtin_prefetch(ahead + byte);
          make_lines(
              task, [&](int k) { return room.live[made + k]; }, room.line, static_cast<int>(made % (2 * kLanes)));
        }
        const Aside aside = task.corners == nullptr
                                ? cross<kMode, true>(task, places, room, line_of + i, chunk + i, i)
                                : cross<kMode, false>(task, places, room, line_of + i, chunk + i, i);
        const std::uint32_t used = n - i < kLanes ? (1U << (n - i)) - 1 : ~0U;
        set_aside(room.corners, static_cast<std::uint32_t>(chunk + i), line_of + i, aside.corners & used);
        set_aside(room.ends, static_cast<std::uint32_t>(chunk + i), line_of + i, aside.ends & used);
      }
      evaluate_pieces<kMode>(room, n);
      for (int i = 0; i < n; i += kLanes)
        finish_crossing<kMode>(task, places, room, pairs, to, line_of + i, chunk + i, i, std::min(kLanes, n - i));
    }
    finish_specials<kMode, false>(task, places, room, room.corners, pairs, to);
    finish_specials<kMode, true>(task, places, room, room.ends, pairs, to);
  }

  /// Without asking whether there are any: wrong guesses cost more.
  [[gnu::always_inline]] static void set_aside(TileRoom::Special& special, std::uint32_t pair,
                                               const std::uint32_t* line, std::uint32_t bits) {
    packet::pack_numbers<P>(&special.line[special.count], &special.pair[special.count], line, pair, bits);
    special.count += static_cast<std::size_t>(std::popcount(bits));
  }

  /// Lists the runs that have pairs; a packet more, all the last. Marks each one's first pair.
  static void list_live_runs(const TileTask& task, const TilePlaces& places, std::size_t count, TileRoom& room) {
    Raster::grow(room.live, std::max<std::size_t>(task.run_count, task.most_runs));
    Raster::grow(room.starts, std::max(count, task.most_pairs) / 8 + TileRoom::kChunk);
    std::fill_n(room.starts.data(), count / 8 + TileRoom::kChunk, std::uint8_t{0});
    std::uint32_t n = 0;
    for (std::uint32_t r = 0; r < task.run_count; ++r) {
      const std::uint32_t begin = places.begin[r], lives = places.begin[r + 1] > begin ? 1 : 0;
      room.live[n] = r;
      room.starts[begin / 8] |= static_cast<std::uint8_t>(lives << begin % 8);
      n += lives;
    }
    std::fill_n(room.live.data() + n, kLanes, n > 0 ? room.live[n - 1] : 0);
  }

  /// How many of bits 0 .. k of a byte are set.
  struct CountsOfBits {
    std::uint8_t of[256][8] = {};

    constexpr CountsOfBits() {
      for (int byte = 0; byte < 256; ++byte)
        for (int k = 0; k < 8; ++k)
          of[byte][k] = static_cast<std::uint8_t>((k > 0 ? of[byte][k - 1] : 0) + (byte >> k & 1));
    }
  };
  static constexpr CountsOfBits kCountsOfBits{};

  /// Numbers the runs of a chunk's pairs among the live ones, by where runs start; `line` is the number of the last
  /// pair before it, and then of its last.
  BURIN_FLATTEN static void number_lines(const std::uint8_t* starts, std::uint32_t& line, std::uint32_t* to) {
    for (int i = 0; i < TileRoom::kChunk; i += 8) {
      std::uint8_t count[8];  // a copy: bytes may lie anywhere, also where numbers are stored
      std::memcpy(count, kCountsOfBits.of[starts[i / 8]], sizeof(count));
      for (int k = 0; k < 8; ++k) to[i + k] = line + count[k];
      line += count[7];
    }
  }

  static void evaluate(const TileTask& task, const TilePlaces& places, TileRoom& room, TilePairs& pairs,
                       const TileJacobian& to) {
    switch (task.mode) {
      case KernelMode::value:
        return evaluate_mode<KernelMode::value>(task, places, room, pairs, to);
      case KernelMode::ends:
        return evaluate_mode<KernelMode::ends>(task, places, room, pairs, to);
      case KernelMode::material:
        return evaluate_mode<KernelMode::material>(task, places, room, pairs, to);
    }
  }

  BURIN_FLATTEN static void cover(const TileTask& task, const TilePlaces& places, const float* covered,
                                  const TileRoom& room, const TileJacobian& to) {
    const std::size_t count = places.begin[task.run_count];
    for (std::size_t i = 0; i < count; i += kLanes) {
      const F base = packet::look_up<P>(covered, &places.place[i]);
      const auto give_back = [&](const std::vector<float>& area, float* of) {
        store(of + i, load(of + i) + base * load(&area[i]));
      };
      give_back(room.area_shift, to.shift);
      give_back(room.area_turn, to.turn);
      if (task.mode != KernelMode::material) continue;
      give_back(room.area_width, to.width);
      give_back(room.area_rim, to.rim);
    }
    for (EndPair* e = to.ends; e != to.ends + to.end_count; ++e) {
      const float base = covered[places.place[e->pair]];
      e->first += base * e->area_first;
      e->second += base * e->area_second;
    }
  }

  template <bool kMaterial>
  BURIN_FLATTEN static void gather_mode(const TileTask& task, const TilePlaces& places, const float* weight,
                                        const TileJacobian& jacobian, float* to) {
    constexpr int kNumbers = run_gradients(kMaterial ? KernelMode::material : KernelMode::ends);
    constexpr int kSums = kMaterial ? 5 : 2;
    const float* const arrays[5] = {jacobian.shift, jacobian.turn, jacobian.width, jacobian.rim, jacobian.alpha};
    const F lane = packet::lane_numbers<P>();
    for (std::uint32_t first = 0; first < task.run_count; first += kLanes) {
      const std::uint32_t stop = std::min<std::uint32_t>(first + kLanes, task.run_count);
      F sums[kSums][kLanes];  // a packet a run: shift, turn, width, rim, alpha
      for (std::uint32_t r = first; r < stop; ++r) {
        const std::size_t last = places.begin[r + 1];
        F sum[kSums];
        for (F& s : sum) s = zero();
        for (std::size_t i = places.begin[r]; i < last; i += kLanes) {
          const Mask in = lane < F(static_cast<float>(last - i));
          const F w = xsimd::select(in, packet::look_up<P>(weight, &places.place[i]), zero());
          for (int k = 0; k < kSums; ++k) sum[k] = sum[k] + w * load(arrays[k] + i);
        }
        for (int k = 0; k < kSums; ++k) sums[k][r - first] = sum[k];
      }
      for (std::uint32_t r = stop; r < first + kLanes; ++r)
        for (int k = 0; k < kSums; ++k) sums[k][r - first] = zero();
      const auto number = [&](int k) { return std::min<std::size_t>(first + k, stop - 1); };
      F run[4], shape[4] = {F(task.shapes[0].per_mm)};
      packet::four_columns(run, [&](int k) { return &task.runs[number(k)].across_x; });
      if (!task.shapes.shared) packet::four_columns(shape, [&](int k) { return &task.shapes[number(k)].per_mm; });
      // The shift acts at the foot of the tile's origin, Y = 0.
      const F shift = packet::sums_of_rows(sums[0]), turn = packet::sums_of_rows(sums[1]);
      const F out[4] = {shape[0] * shift, -(shift * run[3] + turn), zero(), zero()};
      const std::size_t here = stop - first;
      alignas(64) float rows[kLanes][4];
      packet::four_rows(out, rows);
      for (std::size_t k = 0; k < here; ++k) std::memcpy(to + (first + k) * kNumbers, rows[k], sizeof(rows[k]));
      if constexpr (kMaterial) {
        packet::four_rows(
            {packet::sums_of_rows(sums[2]), packet::sums_of_rows(sums[3]), packet::sums_of_rows(sums[4]), zero()},
            rows);
        for (std::size_t k = 0; k < here; ++k) std::memcpy(to + (first + k) * kNumbers + 4, rows[k], sizeof(rows[k]));
      }
    }
    for (const EndPair *e = jacobian.ends, *stop = e + jacobian.end_count; e != stop; ++e) {
      const float w = task.shapes[e->run].per_mm * weight[places.place[e->pair]];
      float* by = to + static_cast<std::size_t>(e->run) * kNumbers;
      by[2] += w * e->first;
      by[3] += w * e->second;
    }
  }

  static void gather(const TileTask& task, const TilePlaces& places, const float* weight, const TileJacobian& jacobian,
                     float* to) {
    if (task.mode == KernelMode::material)
      gather_mode<true>(task, places, weight, jacobian, to);
    else
      gather_mode<false>(task, places, weight, jacobian, to);
  }

  static constexpr TileKernels kernels() { return {find, evaluate, cover, gather}; }
};

}  // namespace burin
