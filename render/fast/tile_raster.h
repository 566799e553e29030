// burin/render/fast/tile_raster.h - pixels of a tile that a scratch touches, many rows at once.
//
// The strip |t| <= rim between its ends is clipped to the tile's box, mapped to the tile's lattice by its block's map,
// and rasterized as a convex quadrilateral. Within a row's slab it is convex too. So its columns are those between the
// extremes of the edges' parts in the slab. Every pixel is widened by the errors of the map and of float rounding,
// which can only add pixels. Rows are widened more, which also covers edges too flat for a reliable slope. A strip much
// thinner than a pixel is rasterized as its widened middle line: it adds few pixels at the ends and halves the work.
// Include only where packet_math.h is permitted.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "burin/render/fast/packet_math.h"
#include "burin/render/fast/tile.h"

namespace burin {

template <class P>
struct TileRaster {
  using F = P;
  using Mask = typename P::batch_bool_type;
  static constexpr int kLanes = kLanesOf<P>;
  using Lanes = float[kLanes];

  struct Edge {
    alignas(64) Lanes x0, y0, x1, y1, slope;  // y0 <= y1
  };
  /// Quadrilaterals of one run per lane, in the lattice of a block.
  struct Quads {
    Edge edge[4];
    alignas(64) Lanes row0, row1;  // first and last row touched
    alignas(64) Lanes e, e_row;    // widening, px
    // Thin strips: v is the axis of their longer extent and u the other axis. u0 + slope v is the middle line and reach
    // the extent in u. u_low .. v_high is the box, widened, and in u clipped to the block. first, last: v touched.
    alignas(64) Lanes u0, slope, reach, u_low, u_high, v_low, v_high, first, last;
    std::uint32_t empty, everything, thin, along_x;
  };
  static constexpr float kThin_px = 0.1F;

  BURIN_FLATTEN static void make(const TileBlock& block, const TileRun* runs, const RunShapes& shapes,
                                 std::size_t first, int count, Quads& out) {
    F run[8];
    for (const int half : {0, 4})
      packet::four_columns(run + half, [&](int k) { return &runs[first + std::min(k, count - 1)].across_x + half; });
    F shape[4] = {F(shapes[0].per_mm), F(shapes[0].rim)};
    if (!shapes.shared)
      packet::four_columns(shape, [&](int k) { return &shapes[first + std::min(k, count - 1)].per_mm; });
    const F &across_x = run[0], &across_y = run[1], &t_origin = run[2];
    const F mm = inverse(shape[0]), half_width = shape[1] * mm;
    const F along_x = -across_y, &along_y = across_x;
    const F foot_x = -t_origin * mm * across_x, foot_y = -t_origin * mm * across_y;
    F from = run[3] * mm, to = run[4] * mm;  // mm along from the foot of the tile's origin
    const auto cut = [&](const F& foot, const F& along, float low, float high) {
      const F margin = half_width * F(1.0001F) + F(1e-5F * (high - low));
      const Mask steep = xsimd::abs(along) > F(1e-6F);
      const F per_along = inverse(xsimd::select(steep, along, F(1.0F)));
      const F a = (F(low) - margin - foot) * per_along, b = (F(high) + margin - foot) * per_along;
      from = xsimd::select(steep, xsimd::max(from, xsimd::min(a, b)), from);
      to = xsimd::select(steep, xsimd::min(to, xsimd::max(a, b)), to);
    };
    cut(foot_x, along_x, block.low_mm[0], block.high_mm[0]);
    cut(foot_y, along_y, block.low_mm[1], block.high_mm[1]);
    out.empty = packet::bits_of<P>(!(from <= to));

    F x[4], y[4];
    F w_least(1.0F), size(static_cast<float>(kTile)), x_low, x_high, y_low, y_high;
    const auto& m = block.lattice_from_mm;
    for (int i = 0; i < 4; ++i) {
      const F& s = i < 2 ? from : to;
      const F side = i == 0 || i == 3 ? -half_width : half_width;
      const F px = foot_x + s * along_x + side * across_x, py = foot_y + s * along_y + side * across_y;
      const F w = F(m[6]) * px + (F(m[7]) * py + F(m[8]));
      const F per_w = inverse(xsimd::max(w, F(1e-3F)));
      x[i] = (F(m[0]) * px + (F(m[1]) * py + F(m[2]))) * per_w;
      y[i] = (F(m[3]) * px + (F(m[4]) * py + F(m[5]))) * per_w;
      w_least = xsimd::min(w_least, w);
      size = xsimd::max(size, xsimd::max(xsimd::abs(x[i]), xsimd::abs(y[i])));
      x_low = i == 0 ? x[0] : xsimd::min(x_low, x[i]);
      x_high = i == 0 ? x[0] : xsimd::max(x_high, x[i]);
      y_low = i == 0 ? y[0] : xsimd::min(y_low, y[i]);
      y_high = i == 0 ? y[0] : xsimd::max(y_high, y[i]);
    }
    // Too near the map's horizon, or not a number: take all pixels.
    const Mask good = (w_least > F(0.02F)) & (size < F(1e6F));
    out.everything = block.by_box ? ~0U : packet::bits_of<P>(!good);
    const F e = F(block.error_px) + F(1e-6F) * size, e_row = F(block.error_px) + F(5e-6F) * size;
    // Half of the strip's width, at its wider end.
    const F half(0.5F);
    const F side_x = half * xsimd::max(xsimd::abs(x[1] - x[0]), xsimd::abs(x[2] - x[3]));
    const F side_y = half * xsimd::max(xsimd::abs(y[1] - y[0]), xsimd::abs(y[2] - y[3]));
    out.thin = packet::bits_of<P>(xsimd::max(side_x, side_y) < F(0.5F * kThin_px));
    const F mx = half * (x[0] + x[1]), my = half * (y[0] + y[1]);
    const F dx = half * (x[2] + x[3]) - mx, dy = half * (y[2] + y[3]) - my;
    const Mask along_x_axis = xsimd::abs(dx) > xsimd::abs(dy);
    out.along_x = packet::bits_of<P>(along_x_axis);
    const auto u_of = [&](const F& of_x, const F& of_y) { return xsimd::select(along_x_axis, of_y, of_x); };
    const auto v_of = [&](const F& of_x, const F& of_y) { return xsimd::select(along_x_axis, of_x, of_y); };
    const F dv = v_of(dx, dy);
    const F slope = u_of(dx, dy) * inverse(xsimd::select(dv == F(0.0F), F(1.0F), dv));
    slope.store_aligned(out.slope);
    (u_of(side_x, side_y) + xsimd::abs(slope) * v_of(side_x, side_y) + F(2.0F) * e).store_aligned(out.reach);
    (u_of(mx, my) - slope * v_of(mx, my)).store_aligned(out.u0);
    const F block_x0(static_cast<float>(block.x0)), block_y0(static_cast<float>(block.y0));
    const F block_x1(static_cast<float>(block.x1)), block_y1(static_cast<float>(block.y1));
    const F last_x = block_x1 - F(1.0F), last_y = block_y1 - F(1.0F), within_last(1.0F - 1e-5F);
    xsimd::max(u_of(x_low, y_low) - e, u_of(block_x0, block_y0)).store_aligned(out.u_low);
    xsimd::min(u_of(x_high, y_high) + e, u_of(last_x, last_y) + within_last).store_aligned(out.u_high);
    const F v_low = v_of(x_low, y_low) - e, v_high = v_of(x_high, y_high) + e;
    v_low.store_aligned(out.v_low);
    v_high.store_aligned(out.v_high);
    xsimd::max(xsimd::floor(v_low), v_of(block_x0, block_y0)).store_aligned(out.first);
    xsimd::min(xsimd::floor(v_high), v_of(last_x, last_y)).store_aligned(out.last);
    const std::uint32_t all = (1U << (kLanes - 1) << 1) - 1;
    if (((out.thin | out.empty) & all) == all) return;
    e.store_aligned(out.e);
    e_row.store_aligned(out.e_row);
    xsimd::ceil(y_low - F(1.0F) - e_row).store_aligned(out.row0);
    xsimd::floor(y_high + e_row).store_aligned(out.row1);
    for (int i = 0; i < 4; ++i) {
      const int j = (i + 1) % 4;
      const Mask up = y[i] > y[j];
      const F x0 = xsimd::select(up, x[j], x[i]), x1 = xsimd::select(up, x[i], x[j]);
      const F y0 = xsimd::min(y[i], y[j]), y1 = xsimd::max(y[i], y[j]);
      const F edge_dy = y1 - y0;
      const Mask trusted = edge_dy > F(3e-6F) * size;
      const F edge_slope = (x1 - x0) / xsimd::select(trusted, edge_dy, F(1.0F));
      Edge& edge = out.edge[i];
      x0.store_aligned(edge.x0);
      y0.store_aligned(edge.y0);
      x1.store_aligned(edge.x1);
      y1.store_aligned(edge.y1);
      xsimd::select(trusted, edge_slope, F(0.0F)).store_aligned(edge.slope);
    }
  }

  /// Writes the places (row * kTile + column) that quadrilateral k touches, up to kTilePixels + 16 entries. Returns the
  /// end of the output. `valid_rows`: one bit per pixel, or null if all are valid.
  BURIN_FLATTEN static std::uint16_t* draw(const TileBlock& block, const Quads& quads, int k,
                                           const std::uint32_t* valid_rows, std::uint16_t* to) {
    if ((quads.empty >> k & 1) != 0) return to;
    if ((quads.everything >> k & 1) != 0) {
      for (int row = block.y0; row < block.y1; ++row) to = put(row, block.x0, block.x1, valid_rows, to);
      return to;
    }
    if ((quads.thin >> k & 1) != 0) return draw_line(quads, k, valid_rows, to);
    const int row0 = std::max(block.y0, static_cast<int>(quads.row0[k]));
    const int row1 = std::min(block.y1 - 1, static_cast<int>(quads.row1[k]));
    for (int first = row0; first <= row1; first += kLanes) {
      const F row = packet::lane_numbers<P>() + F(static_cast<float>(first));
      F low, high;
      extremes_of_quad(quads, k, row, low, high);
      const Mask in = row <= F(static_cast<float>(row1));
      const F begin = xsimd::max(xsimd::floor(low), F(static_cast<float>(block.x0)));
      const F end = xsimd::min(xsimd::floor(high) + F(1.0F), F(static_cast<float>(block.x1)));
      alignas(64) Lanes begins, ends;
      begin.store_aligned(begins);
      end.store_aligned(ends);
      for (std::uint32_t bits = packet::bits_of<P>(in & (begin < end)); bits != 0; bits &= bits - 1) {
        const int r = std::countr_zero(bits);
        to = put(first + r, static_cast<int>(begins[r]), static_cast<int>(ends[r]), valid_rows, to);
      }
    }
    return to;
  }

  /// Widened columns of the strip in the slab row .. row + 1; low is above high if the slab is empty.
  [[gnu::always_inline]] static void extremes_of_quad(const Quads& quads, int k, const F& row, F& low, F& high) {
    const F e(quads.e[k]), e_row(quads.e_row[k]), far(std::numeric_limits<float>::infinity());
    const F top = row - e_row, bottom = row + F(1.0F) + e_row;
    low = far;
    high = -far;
    for (int i = 0; i < 4; ++i) {
      const Edge& edge = quads.edge[i];
      const F x0(edge.x0[k]), y0(edge.y0[k]), y1(edge.y1[k]), slope(edge.slope[k]);
      const F from = xsimd::max(top, y0), until = xsimd::min(bottom, y1);
      const Mask there = from <= until;
      const F a = x0 + slope * (from - y0), b = xsimd::select(until == y1, F(edge.x1[k]), x0 + slope * (until - y0));
      low = xsimd::select(there, xsimd::min(low, xsimd::min(a, b)), low);
      high = xsimd::select(there, xsimd::max(high, xsimd::max(a, b)), high);
    }
    low = low - e;
    high = high + e;
  }

  /// draw() for a thin strip: rows, or columns, of at most a few pixels each. No branch separates the two, because both
  /// kinds alternate.
  [[gnu::always_inline]] static std::uint16_t* draw_line(const Quads& quads, int k, const std::uint32_t* valid_rows,
                                                         std::uint16_t* to) {
    const bool along_x = (quads.along_x >> k & 1) != 0;
    const int first_v = static_cast<int>(quads.first[k]), last_v = static_cast<int>(quads.last[k]);
    const F u0(quads.u0[k]), slope(quads.slope[k]), reach(quads.reach[k]);
    const F u_low(quads.u_low[k]), u_high(quads.u_high[k]), v_low(quads.v_low[k]), v_high(quads.v_high[k]);
    for (int first = first_v; first <= last_v; first += kLanes) {
      const F v = packet::lane_numbers<P>() + F(static_cast<float>(first));
      const F a = u0 + slope * xsimd::max(v, v_low), b = u0 + slope * xsimd::min(v + F(1.0F), v_high);
      const F low = xsimd::max(xsimd::min(a, b) - reach, u_low), high = xsimd::min(xsimd::max(a, b) + reach, u_high);
      const std::uint32_t in_block =
          last_v - first >= kLanes - 1 ? (1U << (kLanes - 1) << 1) - 1 : (2U << (last_v - first)) - 1;
#ifdef __AVX512BW__
      if constexpr (kIs512<P>) {
        if (valid_rows == nullptr) {
          constexpr int kDown = _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC;
          const __m512i u = _mm512_cvt_roundps_epi32(low, kDown), one = _mm512_set1_epi32(1);
          __m512i more = _mm512_sub_epi32(_mm512_cvt_roundps_epi32(high, kDown), u);
          const int u_bits = kTileBits * static_cast<int>(quads.along_x >> k & 1);
          const __m128i of_u = _mm_cvtsi32_si128(u_bits), of_v = _mm_cvtsi32_si128(kTileBits - u_bits);
          const __m512i step = _mm512_sll_epi32(one, of_u);
          __m512i place = _mm512_add_epi32(_mm512_sll_epi32(u, of_u), _mm512_sll_epi32(_mm512_cvttps_epi32(v), of_v));
          __mmask16 left = _mm512_mask_cmpge_epi32_mask(static_cast<__mmask16>(in_block), more, _mm512_setzero_si512());
          const auto put_one = [&] {
            _mm256_storeu_si256(reinterpret_cast<__m256i*>(to),
                                _mm512_cvtepi32_epi16(_mm512_maskz_compress_epi32(left, place)));
            to += std::popcount(static_cast<unsigned>(left));
            place = _mm512_add_epi32(place, step);
            more = _mm512_sub_epi32(more, one);
            left = _mm512_mask_cmpge_epi32_mask(left, more, _mm512_setzero_si512());
            return left != 0;  // more to write
          };
          // A line crosses two pixels of a row, seldom more, so these need no branch.
          put_one();
          while (put_one()) {
          }
          continue;
        }
      }
#endif
      alignas(64) Lanes begins, lasts;
      xsimd::floor(low).store_aligned(begins);
      xsimd::floor(high).store_aligned(lasts);
      for (std::uint32_t bits = in_block; bits != 0; bits &= bits - 1) {
        const int i = std::countr_zero(bits), from_u = static_cast<int>(begins[i]), last_u = static_cast<int>(lasts[i]);
        if (along_x)
          for (int row = from_u; row <= last_u; ++row) to = put(row, first + i, first + i + 1, valid_rows, to);
        else
          to = put(first + i, from_u, last_u + 1, valid_rows, to);
      }
    }
    return to;
  }

  /// Makes a tile's buffer longer than `n` by a SIMD vector. It reserves much more, which costs no memory until use.
  /// Tiles differ and strokes grow, so an iteration seldom needs the heap.
  template <class T>
  static void grow(std::vector<T>& v, std::size_t n) {
    if (v.size() >= n + 16) return;
    if (v.capacity() < n + 16) v.reserve(16 * n + 16);
    v.resize(n + 16);
  }

  /// Places of all runs in order: run r has place[begin[r]] .. place[begin[r + 1] - 1]. 16 zeros follow the last.
  BURIN_FLATTEN static void find(std::span<const TileBlock> blocks, const TileRun* runs, const RunShapes& shapes,
                                 std::uint32_t count, const std::uint32_t* valid_rows,
                                 std::vector<std::uint32_t>& begin, std::vector<std::uint16_t>& place) {
    grow(begin, count);
    std::size_t n = 0;
    const auto next_place = [&] {
      grow(place, n + kTilePixels + 48);
      return place.data() + n;
    };
    Quads quads;
    if (blocks.size() == 1) {
      for (std::uint32_t first = 0; first < count; first += kLanes) {
        const int runs_here = static_cast<int>(std::min<std::uint32_t>(kLanes, count - first));
        make(blocks[0], runs, shapes, first, runs_here, quads);
        for (int k = 0; k < runs_here; ++k) {
          begin[first + k] = static_cast<std::uint32_t>(n);
          n = draw(blocks[0], quads, k, valid_rows, next_place()) - place.data();
        }
      }
    } else {
      for (std::uint32_t r = 0; r < count; ++r) {
        begin[r] = static_cast<std::uint32_t>(n);
        for (const TileBlock& block : blocks) {
          make(block, runs, shapes, r, 1, quads);
          n = draw(block, quads, 0, valid_rows, next_place()) - place.data();
        }
      }
    }
    begin[count] = static_cast<std::uint32_t>(n);
    std::fill_n(next_place(), 16, std::uint16_t{0});
  }

 private:
  static_assert(std::has_single_bit(unsigned{kTile}));
  static constexpr int kTileBits = std::countr_zero(unsigned{kTile});

  [[gnu::always_inline]] static F inverse(const F& x) { return footprint::Arithmetic<F>::inverse(x); }

  static std::uint16_t* put(int row, int begin, int end, const std::uint32_t* valid_rows, std::uint16_t* to) {
    const std::uint32_t valid = valid_rows == nullptr ? ~0U : valid_rows[row];
    for (int c = begin; c < end; ++c)
      if ((valid >> c & 1) != 0) *to++ = static_cast<std::uint16_t>(row * kTile + c);
    return to;
  }
};

}  // namespace burin
