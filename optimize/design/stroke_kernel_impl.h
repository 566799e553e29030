// burin/optimize/design/stroke_kernel_impl.h - the kernel of stroke_kernel.h over a SIMD vector type.
//
// Only files compiled for one instruction set each include it (see burin/render/fast/packet_math.h). They use no fused
// multiply-adds.
#pragma once

#include "burin/optimize/design/shown_light.h"
#include "burin/optimize/design/stroke_kernel.h"
#include "burin/render/fast/packet_math.h"

namespace burin {

template <class P>
struct StrokeKernel {
  using Mask = packet::MaskOf<P>;

  struct Vector {
    P x, y, z;
  };

  // A line through pixels, and the lobes' argument along it: at s, q = start + slope s.
  struct Line {
    P x, y, ux, uy;
    P start[kMostPlaces], slope[kMostPlaces];
  };

  // One of a line's two directions from its point's pixel: its present s, the next borders in x and in y, the distances
  // between borders, and its steps.
  struct Way {
    P s, next_x, next_y, each_x, each_y, step_x, step_y, cell_x, cell_y;
  };

  // The largest running sum of gains, and its distance from the line's point.
  struct Best {
    P sum, at;
  };

  // x = 2^exponent * mantissa, 1 <= mantissa < 2; of positive, normal numbers.
  [[gnu::always_inline]] static void split(const P& x, P& exponent, P& mantissa) {
#ifdef __AVX512BW__
    if constexpr (kIs512<P>) {
      const __m512i i = _mm512_castps_si512(x);
      exponent = _mm512_cvtepi32_ps(_mm512_sub_epi32(_mm512_srli_epi32(i, 23), _mm512_set1_epi32(127)));
      mantissa = _mm512_castsi512_ps(
          _mm512_or_si512(_mm512_and_si512(i, _mm512_set1_epi32(0x7fffff)), _mm512_set1_epi32(0x3f800000)));
      return;
    }
#endif
#ifdef __AVX2__
    if constexpr (sizeof(P) == sizeof(__m256)) {
      const __m256i i = _mm256_castps_si256(x);
      exponent = _mm256_cvtepi32_ps(_mm256_sub_epi32(_mm256_srli_epi32(i, 23), _mm256_set1_epi32(127)));
      mantissa = _mm256_castsi256_ps(
          _mm256_or_si256(_mm256_and_si256(i, _mm256_set1_epi32(0x7fffff)), _mm256_set1_epi32(0x3f800000)));
      return;
    }
#endif
    alignas(64) float lane[P::size], e[P::size], m[P::size];
    x.store_aligned(lane);
    for (std::size_t i = 0; i < P::size; ++i) {
      const auto bits = std::bit_cast<std::uint32_t>(lane[i]);
      e[i] = static_cast<float>(static_cast<std::int32_t>(bits >> 23) - 127);
      m[i] = std::bit_cast<float>((bits & 0x7fffffU) | 0x3f800000U);
    }
    exponent = P::load_aligned(e);
    mantissa = P::load_aligned(m);
  }

  // y 2^whole.
  [[gnu::always_inline]] static P scaled(const P& y, const P& whole) {
#ifdef __AVX512BW__
    if constexpr (kIs512<P>)
      return _mm512_castsi512_ps(
          _mm512_add_epi32(_mm512_castps_si512(y), _mm512_slli_epi32(_mm512_cvttps_epi32(whole), 23)));
#endif
#ifdef __AVX2__
    if constexpr (sizeof(P) == sizeof(__m256))
      return _mm256_castsi256_ps(
          _mm256_add_epi32(_mm256_castps_si256(y), _mm256_slli_epi32(_mm256_cvttps_epi32(whole), 23)));
#endif
    alignas(64) float lane[P::size], by[P::size];
    y.store_aligned(lane);
    whole.store_aligned(by);
    for (std::size_t i = 0; i < P::size; ++i)
      lane[i] = std::bit_cast<float>(std::bit_cast<std::uint32_t>(lane[i]) +
                                     (static_cast<std::uint32_t>(static_cast<std::int32_t>(by[i])) << 23));
    return P::load_aligned(lane);
  }

  // fast_log2, fast_exp2 and shown_light of shown_light.h.
  [[gnu::always_inline]] static P log2(const P& x) {
    P e, m;
    split(x, e, m);
    const P z = m - P(1);
    const P p = ((P(kLog2[3]) * z + P(kLog2[2])) * z + P(kLog2[1])) * z + P(kLog2[0]);
    return e + (z + z * (P(1) - z) * p);
  }
  [[gnu::always_inline]] static P exp2(const P& x) {
    const P whole = xsimd::floor(x), f = x - whole;
    const P p = (P(kExp2[2]) * f + P(kExp2[1])) * f + P(kExp2[0]);
    return scaled(P(1) + f + f * (P(1) - f) * p, whole);
  }
  [[gnu::always_inline]] static P shown(const P& light) {
    return xsimd::min(P(1), exp2(P(kShownPower) * log2(xsimd::max(light, P(kLeastLight)))));
  }

  // The half vector of a point's pixel, or of the picture's nearest pixel.
  static Vector listed_half_vector(const StrokeWindow& window, const StrokePlace& place, const P& x_mm, const P& y_mm) {
    const auto within = [](const P& at, int size) {
      return xsimd::min(xsimd::max(xsimd::floor(at), P(0)), P(static_cast<float>(size - 1)));
    };
    const P column =
        within((x_mm - P(window.left_mm)) / P(window.pitch_x_mm) + P(static_cast<float>(window.column)), window.stride);
    const P row = within((P(window.top_mm) - y_mm) / P(window.pitch_y_mm) + P(static_cast<float>(window.row)),
                         window.picture_height);
    // A float cannot index all pixels: a picture may be larger than the kernel's window.
    alignas(64) std::int32_t columns[P::size], rows[P::size];
    xsimd::to_int(column).store_aligned(columns);
    xsimd::to_int(row).store_aligned(rows);
    P out[4];
    packet::four_columns<P>(out, [&](int lane) {
      return &place.half_vectors[static_cast<std::size_t>(rows[lane]) * window.stride + columns[lane]].x;
    });
    return {out[0], out[1], out[2]};
  }

  // The sum of the unit vectors to eye and lamp, which is parallel to the half vector.
  [[gnu::always_inline]] static Vector half_vector(const StrokeWindow& window, const StrokePlace& place, const P& x_mm,
                                                   const P& y_mm) {
    if (place.half_vectors != nullptr) return listed_half_vector(window, place, x_mm, y_mm);
    const P cx = P(place.camera_mm[0]) - x_mm, cy = P(place.camera_mm[1]) - y_mm, cz(place.camera_mm[2]);
    const P lx = P(place.lamp_mm[0]) - x_mm, ly = P(place.lamp_mm[1]) - y_mm, lz(place.lamp_mm[2]);
    const P c = P(1) / xsimd::sqrt(cx * cx + cy * cy + cz * cz), l = P(1) / xsimd::sqrt(lx * lx + ly * ly + lz * lz);
    return {cx * c + lx * l, cy * c + ly * l, cz * c + lz * l};
  }

  // h . u / alpha.
  [[gnu::always_inline]] static P lobe_place(const Vector& h, const P& ux, const P& uy, const P& alpha) {
    return (h.x * ux + h.y * uy) / (xsimd::sqrt(h.x * h.x + h.y * h.y + h.z * h.z) * alpha);
  }

  [[gnu::always_inline]] static P lobe(const P& q) {
    const P x = P(1) + q * q;
    return P(1) / (x * xsimd::sqrt(x));
  }

  // The four values of each lane's pixel.
  [[gnu::always_inline]] static void pixels_at(const StrokePixel* corner, const std::int32_t* index, P (&out)[4]) {
    packet::four_columns<P>(out, [&](int lane) { return &corner[index[lane]].light; });
  }

  [[gnu::always_inline]] static P matters_at(const float* corner, const std::int32_t* index) {
    alignas(64) float matters[P::size];
    for (std::size_t i = 0; i < P::size; ++i) matters[i] = corner[index[i]];
    return P::load_aligned(matters);
  }

  // Follows a line in one direction (sign 1: ahead, -1: behind) and sums the gains of its pixels. It ends after
  // `limit`, at the window's edge, or after a while without gain. The mask of active lanes only selects the summands,
  // so a core can load the next pixels early. kPlain: one place, all pixels equal.
  template <bool kPlain>
  [[gnu::always_inline]] static Best follow(const StrokeWindow& window, const Line& line, Way way, float sign,
                                            const P& limit, const Mask& wanted, Best best) {
    constexpr float kPatience = 6;  // pixels without gain after which a stroke ends
    const P last_column(static_cast<float>(window.width - 1)), last_row(static_cast<float>(window.height - 1));
    const P stride(static_cast<float>(window.stride));
    P column, row;  // of the pixels, or of their nearest in the window
    const auto goes_on = [&](const Mask& lanes) {
      column = xsimd::min(xsimd::max(way.cell_x, P(0)), last_column);
      row = xsimd::min(xsimd::max(way.cell_y, P(0)), last_row);
      return lanes & (way.cell_x == column) & (way.cell_y == row) & (way.s < limit);
    };
    P sum(0);
    Mask active = goes_on(wanted);
    while (packet::bits_of<P>(active) != 0) {
      alignas(64) std::int32_t index[P::size];
      xsimd::to_int(row * stride + column).store_aligned(index);
      asm("" : "+m"(index));  // extracting single lanes from a register is slow
      const P until = xsimd::min(xsimd::min(way.next_x, way.next_y), limit);
      const P length = xsimd::max(until - way.s, P(0)), middle = P(sign) * (way.s + P(0.5F) * length);
      P gain(0), pixel[4];
      for (int k = 0; k < (kPlain ? 1 : window.places); ++k) {
        pixels_at(window.place[k].pixels, index, pixel);
        const P after = shown(pixel[0] + length * lobe(line.start[k] + line.slope[k] * middle) * pixel[1]);
        // before^2 - after^2 of the excess of the shown value.
        P fall = (pixel[3] - after) * ((pixel[3] - pixel[2]) + (after - pixel[2]));
        if (!kPlain && window.place[k].matters != nullptr) fall = fall * matters_at(window.place[k].matters, index);
        gain = kPlain ? fall : gain + P(window.place[k].weight) * fall;
      }
      if (kPlain) {
        gain = gain * P(window.place[0].weight);
      } else if (window.matters != nullptr) {
        gain = gain * matters_at(window.matters, index);
      }
      if (!kPlain && window.cost != nullptr) gain = gain - length * matters_at(window.cost, index);
      sum = xsimd::select(active, sum + gain, sum);
      const Mask better = active & (sum > best.sum);
      best.sum = xsimd::select(better, sum, best.sum);
      best.at = xsimd::select(better, until, best.at);
      const Mask across_x = way.next_x < way.next_y;
      way.cell_x = xsimd::select(across_x, way.cell_x + way.step_x, way.cell_x);
      way.cell_y = xsimd::select(across_x, way.cell_y, way.cell_y + way.step_y);
      way.next_x = xsimd::select(across_x, way.next_x + way.each_x, way.next_x);
      way.next_y = xsimd::select(across_x, way.next_y, way.next_y + way.each_y);
      way.s = until;
      active = goes_on(active) & (way.s - best.at < P(kPatience));
    }
    return best;
  }

  // The best ends of strokes along a line.
  template <bool kPlain>
  [[gnu::always_inline]] static void best_ends(const StrokeWindow& window, const Line& line, const Mask& wanted,
                                               P& behind, P& ahead, P& gain) {
    const P cell_x = xsimd::floor(line.x), cell_y = xsimd::floor(line.y);
    const P in_x = line.x - cell_x, in_y = line.y - cell_y;
    const Mask right = line.ux > P(0), down = line.uy > P(0);
    const P each_x = P(1) / xsimd::max(xsimd::abs(line.ux), P(1e-9F));
    const P each_y = P(1) / xsimd::max(xsimd::abs(line.uy), P(1e-9F));
    const P back_x = xsimd::select(right, in_x, P(1) - in_x) * each_x;
    const P back_y = xsimd::select(down, in_y, P(1) - in_y) * each_y;
    const P front_x = xsimd::select(right, P(1) - in_x, in_x) * each_x;
    const P front_y = xsimd::select(down, P(1) - in_y, in_y) * each_y;
    const P step_x = xsimd::select(right, P(1), P(-1)), step_y = xsimd::select(down, P(1), P(-1));
    // The start is the line's entry into the point's pixel, so the two directions share no pixel.
    const P entry = xsimd::min(back_x, back_y), half(0.5F * window.longest);
    const Mask across_x = back_x < back_y;
    const Best on =
        follow<kPlain>(window, line, {P(0) - entry, front_x, front_y, each_x, each_y, step_x, step_y, cell_x, cell_y},
                       1, half - entry, wanted, {P(-1e30F), P(0) - entry});
    const Best back = follow<kPlain>(
        window, line,
        {entry, xsimd::select(across_x, back_x + each_x, back_x), xsimd::select(across_x, back_y, back_y + each_y),
         each_x, each_y, P(0) - step_x, P(0) - step_y, xsimd::select(across_x, cell_x - step_x, cell_x),
         xsimd::select(across_x, cell_y, cell_y - step_y)},
        -1, half + entry, wanted, {P(0), entry});
    ahead = on.at;
    behind = P(0) - back.at;
    const Mask long_enough = wanted & ((ahead - behind) >= P(window.shortest));
    gain = xsimd::select(long_enough, on.sum + back.sum, P(0));
  }

  // Value of 1 + q^2 for a try's stroke.
  [[gnu::always_inline]] static P turned_to(const StrokeWindow& window, const StrokeTries& tries, int first,
                                            const Vector& h, const P& alpha, P& side) {
    const P brighter = P::load_unaligned(tries.brighter + first);
    const P old = lobe_place(h, P(tries.old_x), P(tries.old_y), alpha);
    const P near = (P(1) + old * old) * brighter;
    // Missing light of the pixel.
    alignas(64) std::int32_t index[P::size];
    alignas(64) float any[P::size];
    bool some = false;
    for (std::size_t i = 0; i < P::size; ++i) {
      const std::size_t lane = static_cast<std::size_t>(first) + i;
      any[i] = tries.anywhere[lane];
      some = some || any[i] != 0;
      index[i] = any[i] == 0 ? 0  // near ones may be outside
                             : static_cast<std::int32_t>(tries.y[lane]) * window.stride +
                                   static_cast<std::int32_t>(tries.x[lane]);
    }
    const P most = exp2(P(-2.0F / 3) * log2(P(window.dimmest)));
    // Side of the old stroke's turn: the sign of q, seen from the end opposite to (-h.y, h.x).
    const Mask along = (P(tries.old_y) * h.x - P(tries.old_x) * h.y) > P(0);
    const P old_side = xsimd::select(along, P(1), P(-1)) * xsimd::select(old > P(0), P(-1), P(1));
    side = P::load_unaligned(tries.side + first);
    P to = near;
    const Mask anywhere = P::load_aligned(any) != P(0);
    if (some) {
      P pixel[4];
      pixels_at(window.place[0].pixels, index, pixel);
      const P lacks = exp2(P(2.2F) * log2(xsimd::max(pixel[2], P(1e-4F)))) - pixel[0];
      const P part = xsimd::max(lacks * brighter / xsimd::max(pixel[1], P(1e-20F)), P(window.dimmest));
      to = xsimd::select(anywhere, exp2(P(-2.0F / 3) * log2(xsimd::min(part, P(1)))), near);
    }
    side = xsimd::select(anywhere, side, side * old_side);
    return xsimd::min(xsimd::max(to, P(1)), most);
  }

  [[gnu::always_inline]] static void try_packet(const StrokeWindow& window, const StrokeTries& tries, int first,
                                                StrokesFound& found) {
    Line line;
    line.x = P::load_unaligned(tries.x + first);
    line.y = P::load_unaligned(tries.y + first);
    const P alpha = P::load_unaligned(tries.alpha + first);
    const P pitch_x(window.pitch_x_mm), pitch_y(window.pitch_y_mm);
    const P x_mm = P(window.left_mm) + line.x * pitch_x, y_mm = P(window.top_mm) - line.y * pitch_y;
    const Vector h = half_vector(window, window.place[0], x_mm, y_mm);
    P side;
    const P q2 = turned_to(window, tries, first, h, alpha, side) - P(1);
    // Turned by delta from the best direction, which is across h's projection: sin(delta) sin(lean) = alpha q.
    const P shadow2 = xsimd::max(h.x * h.x + h.y * h.y, P(1e-12F)), shadow = xsimd::sqrt(shadow2);
    const P norm = xsimd::sqrt(shadow2 + h.z * h.z);
    const P sine = side * xsimd::min(P(1), alpha * xsimd::sqrt(q2) * norm / shadow);
    const P cosine = xsimd::sqrt(xsimd::max(P(0), P(1) - sine * sine));
    const P ux_mm = (P(0) - h.y * cosine - h.x * sine) / shadow, uy_mm = (h.x * cosine - h.y * sine) / shadow;
    const P ux = ux_mm / pitch_x, uy = P(0) - uy_mm / pitch_y, per_mm = xsimd::sqrt(ux * ux + uy * uy);
    line.ux = ux / per_mm;
    line.uy = uy / per_mm;
    // Lobe arguments are interpolated linearly between the farthest ends of the line.
    const P reach(0.5F * window.longest), reach_mm = reach / per_mm;
    for (int k = 0; k < window.places; ++k) {
      const StrokePlace& place = window.place[k];
      const P after =
          lobe_place(half_vector(window, place, x_mm + reach_mm * ux_mm, y_mm + reach_mm * uy_mm), ux_mm, uy_mm, alpha);
      const P before =
          lobe_place(half_vector(window, place, x_mm - reach_mm * ux_mm, y_mm - reach_mm * uy_mm), ux_mm, uy_mm, alpha);
      line.start[k] = P(0.5F) * (after + before);
      line.slope[k] = (after - before) / P(window.longest);
    }
    const Mask wanted = (packet::lane_numbers<P>() + P(static_cast<float>(first))) < P(static_cast<float>(tries.count));
    P behind, ahead, gain;
    if (window.places == 1 && window.matters == nullptr && window.cost == nullptr)
      best_ends<true>(window, line, wanted, behind, ahead, gain);
    else
      best_ends<false>(window, line, wanted, behind, ahead, gain);
    line.ux.store_unaligned(found.ux + first);
    line.uy.store_unaligned(found.uy + first);
    behind.store_unaligned(found.behind + first);
    ahead.store_unaligned(found.ahead + first);
    gain.store_unaligned(found.gain + first);
  }

  static void try_strokes(const StrokeWindow& window, const StrokeTries& tries, StrokesFound& found) {
    for (int first = 0; first < kStrokeLanes; first += kLanesOf<P>) {
      if (first < tries.count) {
        try_packet(window, tries, first, found);
      } else {
        for (int i = 0; i < kLanesOf<P>; ++i) found.gain[first + i] = 0;
      }
    }
  }
};

}  // namespace burin
