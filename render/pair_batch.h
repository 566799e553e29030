// render/pair_batch.h - the fast path's inner loop: value and derivatives of many (pixel, scratch) pairs in float
// packets.
//
// One batch holds pairs of any scratches with any pixels, one a lane, as arrays. A kernel of some SIMD width turns the
// inputs into the outputs; best_kernel() picks the widest that this machine runs.
// Frames: a pixel's corners are in board xy, mm, from the origin of its tile; a scratch brings one affine map from
// there to its own units, t = 2 x / wt across and Y = 2 y / wt along, made in double, so that float keeps its digits.
// Source: DESIGN 3.3 and 7; the integrals are render/footprint_core.h.
//
// Along the groove, the footprint cut with the scratch is bounded by top(t) and bottom(t), both linear between
// breakpoints: the corners, and where edges meet the scratch's ends. With W the weight of footprint_core.h,
//   V = integral of (top - bottom) W dt,                    Dhat = (wt/2)^2 (alpha^2 / pi) V
//   dV/d(shift of the scratch by one unit across)  = integral of (top' - bottom') W dt
//   dV/d(turn of the scratch about t = 0, Y = 0)   = -integral of (top top' - bottom bottom') W dt + hy dV/dhx,
//       where a level that is a pixel's edge brings another -t, which cancels unless the other level is an end
//   dV/d(end moved along)                          = integral of W dt over where that end bounds the region
// Each piece between breakpoints is one evaluation of mean_moments(); most pairs have a single one, [-rim, rim].
#pragma once

#include <cstddef>
#include <cstdint>

namespace burin {

/// What a kernel computes: `value` only; `ends`: and derivatives by the scratch's ends; `material`: and by wt, d,
/// alpha.
enum class BatchMode : std::uint8_t { value, ends, material };

/// Which kernels there are: `generic` is what the compiler's base line allows (SSE2, NEON).
enum class SimdWidth : std::uint8_t { best, generic, avx2, avx512 };

struct alignas(64) PairBatch {
  static constexpr int kCapacity = 256;
  /// An odd number of cache lines: lanes of the same place must not all fall into the same set of the cache.
  using Lanes = float[kCapacity + 16];

  int count = 0;  ///< lanes in use

  // Of the pixel: corners in counter-clockwise order, half vector in the face's frame, tan^2 of wi and wo.
  Lanes x[4], y[4];  ///< mm from the tile's origin; the kernel leaves t and Y there
  Lanes h_x, h_y, h_z, tan2_i, tan2_o;

  // Of the scratch, seen from the tile's origin.
  Lanes across_x, across_y;     ///< unit vector across it
  Lanes per_mm;                 ///< 2 / wt
  Lanes t_origin;               ///< t of the tile's origin
  Lanes first_end, second_end;  ///< Y of the ends; Y = 0 at the foot of the tile's origin
  Lanes alpha, rim;

  // Out. Light is Dhat G, mm^2; area mm^2. Derivatives: shift a unit of t, turn a radian.
  Lanes light, area;
  Lanes light_shift, light_turn, area_shift, area_turn;
  /// `light_width`: what times 1 / wt is the derivative by wt at fixed rim; `_rim` by the rim T.
  Lanes light_width, light_alpha, light_rim, area_rim;

  // Pairs that an end of the scratch may bound (few): their lanes, and the derivatives by ends moved along, a unit of
  // Y.
  int end_count = 0;
  int end_lane[kCapacity];
  Lanes light_first, light_second, area_first, area_second;  ///< by place in end_lane

  // Room for the kernels.
  static constexpr int kPieces = 512;
  using Pieces = float[kPieces + 16];
  Lanes raw_V, raw_shift, raw_turn, raw_width, raw_radial, raw_rim, raw_first, raw_second;
  Lanes piece_t1, piece_t2, piece_top1, piece_top2, piece_bottom1, piece_bottom2;
  int extra_count = 0;
  int extra_lane[kPieces];
  Pieces extra_t1, extra_t2, extra_top1, extra_top2, extra_bottom1, extra_bottom2, extra_first, extra_second;
  Pieces extra_hx, extra_hy, extra_hz, extra_alpha;
};

using BatchKernel = void (*)(PairBatch& batch, BatchMode mode);

/// The kernel of a width. Throws Error if this machine or this build cannot run it; `best` always works.
BatchKernel batch_kernel(SimdWidth width);

/// True where batch_kernel(width) would not throw.
bool has_kernel(SimdWidth width);

/// Lanes of a kernel's packets.
int kernel_lanes(SimdWidth width);

}  // namespace burin
