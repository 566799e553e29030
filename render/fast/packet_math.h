// burin/render/fast/packet_math.h - functions of SIMD vectors beyond xsimd: fast exact divisions, masks as bits,
// transposed loads and stores, and packing of selected lanes.
//
// Only files compiled for one instruction set each include it. Everything depends on the vector type, which differs
// between them. The linker keeps one copy of an inline function, and this machine might not support that copy.
// Operations that only AVX-512 has use its intrinsics; other types go lane by lane through memory.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <xsimd/xsimd.hpp>

#include "burin/render/fast/tile.h"
#include "burin/render/footprint/footprint_core.h"

#ifdef __SSE2__
#include <immintrin.h>
#endif

/// For a kernel's stages: inlines all of their calls. Disabled with a sanitizer, whose checks make the functions so
/// long that GCC needs many minutes.
#ifdef __SANITIZE_ADDRESS__
#define BURIN_FLATTEN
#else
#define BURIN_FLATTEN [[gnu::flatten]]
#endif

namespace burin {

template <class P>
inline constexpr int kLanesOf = static_cast<int>(P::size);

#ifdef __AVX512BW__

using Packet512 = xsimd::batch<float, xsimd::avx512bw>;
template <class P>
inline constexpr bool kIs512 = std::is_same_v<P, Packet512>;

namespace footprint {

/// One Newton step on the 14-bit estimates: error 1 part in 2^23, at a fifth of the cost of vdivps and vsqrtps.
template <>
struct Arithmetic<Packet512> {
  using P = Packet512;
  [[gnu::always_inline]] static P inverse(const P& x) {
    const __m512 r = _mm512_rcp14_ps(x);
    return _mm512_fmadd_ps(r, _mm512_fnmadd_ps(x, r, _mm512_set1_ps(1.0F)), r);
  }
  [[gnu::always_inline]] static P inverse_sqrt(const P& x) {
    const __m512 r = _mm512_rsqrt14_ps(x), half_r = _mm512_mul_ps(r, _mm512_set1_ps(0.5F));
    return _mm512_fmadd_ps(half_r, _mm512_fnmadd_ps(_mm512_mul_ps(x, r), r, _mm512_set1_ps(1.0F)), r);
  }
  /// 1 + x = 2^k (1 + z) with z in [-1/4, 1/2), exactly x for k = 0; log(1 + z) = 2 atanh(z / (2 + z)).
  [[gnu::always_inline]] static P log1p(const P& x) {
    const __m512 one = _mm512_set1_ps(1.0F);
    const __m512 y = _mm512_add_ps(x, one);
    const __m512 m = _mm512_getmant_ps(y, _MM_MANT_NORM_p75_1p5, _MM_MANT_SIGN_src);
    const __m512 exponent = _mm512_getexp_ps(y);
    const __m512 k = _mm512_mask_add_ps(exponent, _mm512_cmp_ps_mask(m, one, _CMP_LT_OQ), exponent, one);
    const __m512 z =
        _mm512_mask_mov_ps(_mm512_sub_ps(m, one), _mm512_cmp_ps_mask(k, _mm512_setzero_ps(), _CMP_EQ_OQ), x);
    const __m512 s = _mm512_mul_ps(z, inverse(_mm512_add_ps(z, _mm512_set1_ps(2.0F))));
    const __m512 s2 = _mm512_mul_ps(s, s), twice = _mm512_add_ps(s, s);
    __m512 tail = _mm512_fmadd_ps(s2, _mm512_set1_ps(2.0F / 9), _mm512_set1_ps(2.0F / 7));
    tail = _mm512_fmadd_ps(s2, tail, _mm512_set1_ps(2.0F / 5));
    tail = _mm512_fmadd_ps(s2, tail, _mm512_set1_ps(2.0F / 3));
    const __m512 log_m = _mm512_fmadd_ps(_mm512_mul_ps(s, s2), tail, twice);
    return _mm512_fmadd_ps(k, _mm512_set1_ps(0.693147181F), log_m);
  }
};

}  // namespace footprint

#else

template <class P>
inline constexpr bool kIs512 = false;

#endif

namespace packet {

template <class P>
using MaskOf = typename P::batch_bool_type;

/// Bit i of the result is lane i of the mask.
template <class P>
[[gnu::always_inline]] inline std::uint32_t bits_of(const MaskOf<P>& mask) {
  if constexpr (kIs512<P>) {
    return static_cast<std::uint32_t>(mask.data);
  } else {
#ifdef __AVX2__
    if constexpr (sizeof(P) == sizeof(__m256)) return static_cast<std::uint32_t>(_mm256_movemask_ps(mask.data));
#endif
    alignas(64) bool lanes[kLanesOf<P>];
    mask.store_unaligned(lanes);
    std::uint32_t bits = 0;
    for (int i = 0; i < kLanesOf<P>; ++i) bits |= static_cast<std::uint32_t>(lanes[i]) << i;
    return bits;
  }
}

/// Packs the lanes of `v` selected by `bits` to `to`. May overwrite a whole vector there.
template <class P>
[[gnu::always_inline]] inline void pack(float* to, const P& v, std::uint32_t bits) {
#ifdef __AVX512BW__
  if constexpr (kIs512<P>) {
    _mm512_storeu_ps(to, _mm512_maskz_compress_ps(static_cast<__mmask16>(bits), v));
    return;
  }
#endif
  alignas(64) float lanes[kLanesOf<P>];
  v.store_aligned(lanes);
  for (; bits != 0; bits &= bits - 1) *to++ = lanes[std::countr_zero(bits)];
}

/// Packs those of from[0 .. lanes - 1] selected by `bits` to `to`, and the numbers of these lanes, counted from
/// `first`, to `number`. May overwrite whole vectors there.
template <class P>
[[gnu::always_inline]] inline void pack_numbers(std::uint32_t* to, std::uint32_t* number, const std::uint32_t* from,
                                                std::uint32_t first, std::uint32_t bits) {
#ifdef __AVX512BW__
  if constexpr (kIs512<P>) {
    const auto mask = static_cast<__mmask16>(bits);
    const __m512i lanes = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
    _mm512_storeu_si512(to, _mm512_maskz_compress_epi32(mask, _mm512_loadu_si512(from)));
    _mm512_storeu_si512(
        number, _mm512_maskz_compress_epi32(mask, _mm512_add_epi32(lanes, _mm512_set1_epi32(static_cast<int>(first)))));
    return;
  }
#endif
  for (; bits != 0; bits &= bits - 1) {
    const int k = std::countr_zero(bits);
    *to++ = from[k];
    *number++ = first + static_cast<std::uint32_t>(k);
  }
}

/// The four floats at row(lane) of each lane, as one vector for each of the four.
template <class P, class Row>
[[gnu::always_inline]] inline void four_columns(P* out, const Row& row) {
#ifdef __AVX512BW__
  if constexpr (kIs512<P>) {
    const auto quarters = [&](int i) {
      __m512 v = _mm512_castps128_ps512(_mm_loadu_ps(row(i)));
      v = _mm512_insertf32x4(v, _mm_loadu_ps(row(i + 4)), 1);
      v = _mm512_insertf32x4(v, _mm_loadu_ps(row(i + 8)), 2);
      return _mm512_insertf32x4(v, _mm_loadu_ps(row(i + 12)), 3);
    };
    const __m512 r0 = quarters(0), r1 = quarters(1), r2 = quarters(2), r3 = quarters(3);
    const __m512 a = _mm512_unpacklo_ps(r0, r1), b = _mm512_unpackhi_ps(r0, r1);
    const __m512 c = _mm512_unpacklo_ps(r2, r3), d = _mm512_unpackhi_ps(r2, r3);
    out[0] = _mm512_shuffle_ps(a, c, 0x44);
    out[1] = _mm512_shuffle_ps(a, c, 0xee);
    out[2] = _mm512_shuffle_ps(b, d, 0x44);
    out[3] = _mm512_shuffle_ps(b, d, 0xee);
    return;
  }
#endif
#ifdef __AVX2__
  if constexpr (sizeof(P) == sizeof(__m256)) {
    const auto halves = [&](int i) {
      return _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_loadu_ps(row(i))), _mm_loadu_ps(row(i + 4)), 1);
    };
    const __m256 r0 = halves(0), r1 = halves(1), r2 = halves(2), r3 = halves(3);
    const __m256 a = _mm256_unpacklo_ps(r0, r1), b = _mm256_unpackhi_ps(r0, r1);
    const __m256 c = _mm256_unpacklo_ps(r2, r3), d = _mm256_unpackhi_ps(r2, r3);
    out[0] = _mm256_shuffle_ps(a, c, 0x44);
    out[1] = _mm256_shuffle_ps(a, c, 0xee);
    out[2] = _mm256_shuffle_ps(b, d, 0x44);
    out[3] = _mm256_shuffle_ps(b, d, 0xee);
    return;
  }
#endif
  alignas(64) float lanes[4][kLanesOf<P>];
  for (int i = 0; i < kLanesOf<P>; ++i) {
    const float* from = row(i);
    for (int c = 0; c < 4; ++c) lanes[c][i] = from[c];
  }
  for (int c = 0; c < 4; ++c) out[c] = P::load_aligned(lanes[c]);
}

/// Inverse of four_columns(): row i is lane i of the four vectors.
template <class P>
[[gnu::always_inline]] inline void four_rows(const P (&c)[4], float (*to)[4]) {
#ifdef __AVX512BW__
  if constexpr (kIs512<P>) {
    const __m512 a = _mm512_unpacklo_ps(c[0], c[1]), b = _mm512_unpackhi_ps(c[0], c[1]);
    const __m512 d = _mm512_unpacklo_ps(c[2], c[3]), e = _mm512_unpackhi_ps(c[2], c[3]);
    const __m512 r[4] = {_mm512_shuffle_ps(a, d, 0x44), _mm512_shuffle_ps(a, d, 0xee), _mm512_shuffle_ps(b, e, 0x44),
                         _mm512_shuffle_ps(b, e, 0xee)};
    for (int i = 0; i < 4; ++i) {
      _mm_storeu_ps(to[i], _mm512_castps512_ps128(r[i]));
      _mm_storeu_ps(to[4 + i], _mm512_extractf32x4_ps(r[i], 1));
      _mm_storeu_ps(to[8 + i], _mm512_extractf32x4_ps(r[i], 2));
      _mm_storeu_ps(to[12 + i], _mm512_extractf32x4_ps(r[i], 3));
    }
    return;
  }
#endif
  alignas(64) float lanes[4][kLanesOf<P>];
  for (int k = 0; k < 4; ++k) c[k].store_aligned(lanes[k]);
  for (int i = 0; i < kLanesOf<P>; ++i)
    for (int k = 0; k < 4; ++k) to[i][k] = lanes[k][i];
}

/// to[0 .. 2 lanes - 1] = a0, b0, a1, b1, ...
template <class P>
[[gnu::always_inline]] inline void interleave(const P& a, const P& b, float* to) {
#ifdef __AVX512BW__
  if constexpr (kIs512<P>) {
    const __m512i low = _mm512_setr_epi32(0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23);
    _mm512_storeu_ps(to, _mm512_permutex2var_ps(a, low, b));
    _mm512_storeu_ps(to + 16, _mm512_permutex2var_ps(a, _mm512_add_epi32(low, _mm512_set1_epi32(8)), b));
    return;
  }
#endif
  alignas(64) float in_a[kLanesOf<P>], in_b[kLanesOf<P>];
  a.store_aligned(in_a);
  b.store_aligned(in_b);
  for (int i = 0; i < kLanesOf<P>; ++i) {
    to[2 * i] = in_a[i];
    to[2 * i + 1] = in_b[i];
  }
}

/// Sum of the lanes in a fixed order. xsimd's order differs between versions, and so does its last bit.
template <class P>
[[gnu::always_inline]] inline float sum(const P& v) {
#ifdef __AVX512BW__
  if constexpr (kIs512<P>) return _mm512_reduce_add_ps(v);
#endif
#ifdef __AVX__
  if constexpr (P::size == 8) {
    const __m256 all = v;
    const __m128 half = _mm_add_ps(_mm256_castps256_ps128(all), _mm256_extractf128_ps(all, 1));
    const __m128 pairs = _mm_hadd_ps(half, half);
    return _mm_cvtss_f32(_mm_hadd_ps(pairs, pairs));
  }
#endif
#ifdef __SSE2__
  if constexpr (P::size == 4) {
    const __m128 all = v;
    const __m128 pairs = _mm_add_ps(all, _mm_movehl_ps(all, all));
    return _mm_cvtss_f32(_mm_add_ss(pairs, _mm_shuffle_ps(pairs, pairs, 1)));
  }
#endif
  alignas(64) float lane[P::size];
  v.store_aligned(lane);
  for (std::size_t n = P::size / 2; n > 0; n /= 2)
    for (std::size_t i = 0; i < n; ++i) lane[i] += lane[i + n];
  return lane[0];
}

/// Lane k of the result is the sum of the lanes of rows[k].
template <class P>
[[gnu::always_inline]] inline P sums_of_rows(const P* rows) {
#ifdef __AVX512BW__
  if constexpr (kIs512<P>) {
    // Four steps. Each halves the number of rows; their lanes are sums of half as many lanes of two rows.
    __m512 a[8], b[4], c[2];
    for (int i = 0; i < 8; ++i) {
      const __m512 x = rows[i + i / 4 * 4], y = rows[i + i / 4 * 4 + 4];
      a[i] = _mm512_add_ps(_mm512_shuffle_f32x4(x, y, 0x44), _mm512_shuffle_f32x4(x, y, 0xee));
    }
    for (int i = 0; i < 4; ++i)
      b[i] = _mm512_add_ps(_mm512_shuffle_f32x4(a[i], a[i + 4], 0x88), _mm512_shuffle_f32x4(a[i], a[i + 4], 0xdd));
    for (int i = 0; i < 2; ++i)
      c[i] = _mm512_add_ps(_mm512_shuffle_ps(b[2 * i], b[2 * i + 1], 0x44),
                           _mm512_shuffle_ps(b[2 * i], b[2 * i + 1], 0xee));
    return _mm512_add_ps(_mm512_shuffle_ps(c[0], c[1], 0x88), _mm512_shuffle_ps(c[0], c[1], 0xdd));
  }
#endif
  alignas(64) float sums[kLanesOf<P>];
  for (int i = 0; i < kLanesOf<P>; ++i) sums[i] = sum(rows[i]);
  return P::load_aligned(sums);
}

/// 0, 1, 2, ...
template <class P>
[[gnu::always_inline]] inline P lane_numbers() {
  alignas(64) constexpr float numbers[16] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
  return P::load_aligned(numbers);
}

/// Table lookup per lane in a table of two vectors. Lane k takes entry index[k], modulo the table's length.
template <class P>
class Picker {
 public:
  [[gnu::always_inline]] explicit Picker(const std::uint32_t* index) : index_(index) {}
  [[gnu::always_inline]] P operator()(const float* table) const {
#ifdef __AVX512BW__
    if constexpr (kIs512<P>)
      return _mm512_permutex2var_ps(_mm512_loadu_ps(table), _mm512_loadu_si512(index_), _mm512_loadu_ps(table + 16));
#endif
#ifdef __AVX2__
    if constexpr (sizeof(P) == sizeof(__m256)) {
      const __m256i i = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(index_));
      return _mm256_blendv_ps(_mm256_permutevar8x32_ps(_mm256_loadu_ps(table), i),
                              _mm256_permutevar8x32_ps(_mm256_loadu_ps(table + 8), i),
                              _mm256_castsi256_ps(_mm256_slli_epi32(i, 28)));
    }
#endif
    alignas(64) float lanes[kLanesOf<P>];
    for (int k = 0; k < kLanesOf<P>; ++k) lanes[k] = table[index_[k] % (2 * kLanesOf<P>)];
    return P::load_aligned(lanes);
  }

 private:
  const std::uint32_t* index_;
};

/// A vector of doubles with half as many lanes, and its conversion from and to floats in memory.
template <class P>
using DoublesOf = xsimd::batch<double, typename P::arch_type>;

template <class P>
[[gnu::always_inline]] inline DoublesOf<P> doubles(const float* from) {
#ifdef __AVX512BW__
  if constexpr (kIs512<P>) return _mm512_cvtps_pd(_mm256_loadu_ps(from));
#endif
#ifdef __AVX2__
  if constexpr (sizeof(P) == sizeof(__m256)) return _mm256_cvtps_pd(_mm_loadu_ps(from));
#endif
  return DoublesOf<P>::load_unaligned(from);
}

template <class P>
[[gnu::always_inline]] inline void store_floats(float* to, const DoublesOf<P>& v) {
#ifdef __AVX512BW__
  if constexpr (kIs512<P>) {
    _mm256_storeu_ps(to, _mm512_cvtpd_ps(v));
    return;
  }
#endif
#ifdef __AVX2__
  if constexpr (sizeof(P) == sizeof(__m256)) {
    _mm_storeu_ps(to, _mm256_cvtpd_ps(v));
    return;
  }
#endif
  v.store_unaligned(to);
}

/// Columns and rows of places[0 .. lanes - 1], row * kTile + column.
template <class P>
[[gnu::always_inline]] inline void columns_and_rows(const std::uint16_t* places, P& column, P& row) {
  static_assert(kTile == 32);
#ifdef __AVX512BW__
  if constexpr (kIs512<P>) {
    const __m512i place = _mm512_cvtepu16_epi32(_mm256_loadu_si256(reinterpret_cast<const __m256i*>(places)));
    column = _mm512_cvtepi32_ps(_mm512_and_si512(place, _mm512_set1_epi32(kTile - 1)));
    row = _mm512_cvtepi32_ps(_mm512_srli_epi32(place, 5));
    return;
  }
#endif
#ifdef __AVX2__
  if constexpr (sizeof(P) == sizeof(__m256)) {
    const __m256i place = _mm256_cvtepu16_epi32(_mm_loadu_si128(reinterpret_cast<const __m128i*>(places)));
    column = _mm256_cvtepi32_ps(_mm256_and_si256(place, _mm256_set1_epi32(kTile - 1)));
    row = _mm256_cvtepi32_ps(_mm256_srli_epi32(place, 5));
    return;
  }
#endif
  alignas(64) float columns[kLanesOf<P>], rows[kLanesOf<P>];
  for (int i = 0; i < kLanesOf<P>; ++i) {
    columns[i] = static_cast<float>(places[i] % kTile);
    const int whole_rows = places[i] / kTile;
    rows[i] = static_cast<float>(whole_rows);
  }
  column = P::load_aligned(columns);
  row = P::load_aligned(rows);
}

/// table[index[0 .. lanes - 1]].
template <class P>
[[gnu::always_inline]] inline P look_up(const float* table, const std::uint16_t* index) {
#ifdef __AVX512BW__
  if constexpr (kIs512<P>)
    return _mm512_i32gather_ps(_mm512_cvtepu16_epi32(_mm256_loadu_si256(reinterpret_cast<const __m256i*>(index))),
                               table, 4);
#endif
  alignas(64) float lanes[kLanesOf<P>];
  for (int i = 0; i < kLanesOf<P>; ++i) lanes[i] = table[index[i]];
  return P::load_aligned(lanes);
}

/// The integers at `from`.
template <class P>
[[gnu::always_inline]] inline P load_shorts(const std::int16_t* from) {
#ifdef __AVX512BW__
  if constexpr (kIs512<P>)
    return _mm512_cvtepi32_ps(_mm512_cvtepi16_epi32(_mm256_loadu_si256(reinterpret_cast<const __m256i*>(from))));
#endif
#ifdef __AVX2__
  if constexpr (sizeof(P) == sizeof(__m256))
    return P(_mm256_cvtepi32_ps(_mm256_cvtepi16_epi32(_mm_loadu_si128(reinterpret_cast<const __m128i*>(from)))));
#endif
  alignas(64) float lanes[kLanesOf<P>];
  for (int i = 0; i < kLanesOf<P>; ++i) lanes[i] = from[i];
  return P::load_aligned(lanes);
}

}  // namespace packet
}  // namespace burin
