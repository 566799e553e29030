// burin/render/fast/tile_kernel.h - the fast path's inner loop: light of the scratches of one tile in its pixels, with
// derivatives, in float SIMD vectors.
//
// A tile's pairs (pixel, scratch) are in the order of scratches. find() finds them. evaluate() sums light and area of
// each pixel. It also computes the derivatives of each pair's light minus the plain face's light under it. cover()
// removes the plain face from pixels that turn out to be fully covered. gather() is the backward pass. Kernels of
// several SIMD widths do the same work; tile_kernels() selects one.
// Frames: burin/render/fast/tile.h. Source: docs/model.md 4 and 8.2 to 8.5; the integrals are
// burin/render/footprint/footprint_core.h.
//
// Along the groove, top(t) and bottom(t) bound the footprint cut with the scratch. Both are linear between breakpoints:
// the corners, and the intersections of edges with the scratch's ends. With W the weight of footprint_core.h,
//   V = integral of (top - bottom) W dt,                    Dhat = (wt/2)^2 (alpha^2 / pi) V
//   dV/d(shift of the scratch by one unit across)  = integral of (top' - bottom') W dt
//   dV/d(turn of the scratch about t = 0, Y = 0)   = -integral of (top top' - bottom bottom') W dt + hy dV/dhx,
//       where a level that is a pixel's edge adds another -t, which cancels unless the other level is an end
//   dV/d(end moved along)                          = integral of W dt over the t where this end bounds the region
// Each piece between breakpoints is one evaluation of mean moments. Most pairs have a single piece, [-rim, rim]: no
// corner of the pixel is on the groove, and an end in the pixel crosses the groove inside it. They are evaluated
// directly. Other pairs are deferred; their pieces are packed, so that SIMD vectors stay full.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "burin/base/simd_width.h"
#include "burin/render/fast/tile.h"

namespace burin {

/// Outputs of a kernel. `value`: light alone. `ends`: also derivatives by the scratch's ends. `material`: also by wt, d
/// and alpha.
enum class KernelMode : std::uint8_t { value, ends, material };

struct TileCurves;  // burin/render/fast/curve_tables.h

/// A pair bounded by an end of its scratch. Derivatives of its light in the pixel and of its covered area, as an end
/// moves along by a unit of Y.
struct EndPair {
  std::uint32_t pair = 0, run = 0;
  float first = 0, second = 0, area_first = 0, area_second = 0;
};

/// Pixels that a tile's runs touch: run r has place[begin[r]] .. place[begin[r + 1] - 1].
struct TilePlaces {
  const std::uint32_t* begin = nullptr;  ///< one more entry than runs
  const std::uint16_t* place = nullptr;  ///< row * kTile + column; readable 16 beyond the last
};

/// TilePlaces in arrays that grow to the largest tile.
struct FoundPlaces {
  std::vector<std::uint32_t> begin;
  std::vector<std::uint16_t> place;

  TilePlaces places() const { return {begin.data(), place.data()}; }
};

/// Derivatives of each pair's light minus the plain face's light under it. They are by a shift of one unit of t, a turn
/// of one radian, log wt at a fixed rim, the rim, and alpha. TileTask::by_half_vector adds the half vector's components
/// across and along the scratch, of which the third is a function. Arrays extend one whole SIMD vector beyond the last
/// pair, with finite numbers.
struct TileJacobian {
  float *shift = nullptr, *turn = nullptr, *width = nullptr, *rim = nullptr, *alpha = nullptr;
  float *h_across = nullptr, *h_along = nullptr;
  EndPair* ends = nullptr;
  std::size_t end_count = 0;
};

/// Results of evaluate() except the Jacobian. Arrays grow to the largest tile and may be longer than their used part.
struct TilePairs {
  std::vector<float> light;  ///< Dhat G, mm^2; only on request
  std::vector<EndPair> ends;
};

/// Input of evaluate(). `runs` must be readable one entry beyond the last.
struct TileTask {
  const TileLattice* lattice = nullptr;
  const TileCorners* corners = nullptr;  ///< null if all corners are on the lattice
  const TileShading* shading = nullptr;
  const TileCurves* curves = nullptr;  ///< CurveKernels only, which need no shading
  const float* base = nullptr;         ///< the plain face's light per mm^2 of each pixel; unused for `value`
  const TileRun* runs = nullptr;
  RunShapes shapes;
  std::uint32_t run_count = 0;
  std::span<const TileBlock> blocks;
  const std::uint32_t* valid_rows = nullptr;  ///< one bit per pixel with a footprint; null if all have one
  KernelMode mode = KernelMode::value;
  bool keep_light = false;      ///< fills TilePairs::light
  bool by_half_vector = false;  ///< with `material`: fills TileJacobian::h_across and h_along
  /// Maxima over all tiles so far. Buffers have this size, so they need not grow at the next larger tile.
  std::size_t most_runs = 0, most_pairs = 0;
};

/// Constants of a scratch for its pairs: t and Y as functions of the tile's lattice, in the units of TileRun. The
/// middle of pixel (column, row) is at t = mid + column * by column + row * by row.
///
/// Pixels may be much larger than the groove. Then t runs over hundreds within a tile, while an edge within the groove
/// must be accurate to 1e-6. So t has two parts. The `coarse` parts are multiples of one number. It is large enough
/// that its small integer multiples, their sums and half sums are exact in float. The `fine` parts are the remainders.
enum Line : std::uint8_t {
  kAcrossX,  // as in TileRun and RunShape
  kAcrossY,
  kPerMm,
  kUnit,  // 1 / kPerMm^2: mm^2 per unit of t times unit of Y
  kFirstEnd,
  kSecondEnd,
  kAlpha,
  kRim,
  kMidCoarse,  // t of the middle of pixel (0, 0)
  kMidFine,
  kColumnCoarse,  // its change by a column
  kColumnFine,
  kRowCoarse,
  kRowFine,
  kReachCoarse,  // reach of a pixel to either side of its middle in t
  kReachFine,
  kMidY,
  kOriginY,  // of pixels with their own lines
  kColumnY,
  kRowY,
  kReachY,  // reach in Y
  kFarY,    // Y, from the middle, of the corner with the largest t
  kSteep,   // dY / dt of a pixel's sides, the larger first
  kFlat,
  kLineConstants
};

/// Deferred pairs: their numbers, and the numbers of their runs among the live ones.
struct PairsSetAside {
  std::size_t count = 0;
  std::vector<std::uint32_t> pair, line;
};

/// One thread's buffers.
struct TileBuffers {
  static constexpr int kChunk = 128;  ///< pairs that pass the stages together
  static constexpr int kPieces = 512;
  static constexpr int kLines = 32;
  /// Rounded up to a whole SIMD vector, and an odd number of cache lines apart. So entries with one index do not all
  /// fall into the same set of the cache.
  template <int n>
  using Lanes = float[n + 16];
  /// A chunk's direct pairs that an end bounds, as in EndPair; `line`: of their runs among the live ones.
  struct DirectEnds {
    int count = 0;
    std::uint32_t pair[kChunk + 16], line[kChunk + 16];
    Lanes<kChunk> first, second, area_first, area_second;
  };

  alignas(64) float sums[2 * kTilePixels] = {};  ///< of each pixel: light, area (mm^2)
  /// Per pixel, if all scratches have one shape: x and y of the half vector, G alpha^2 / pi, and the base; and d
  /// log(alpha^2 G) / d alpha.
  alignas(64) float lit[kTilePixels][4], lit_by_alpha[kTilePixels];
  /// Derivatives of area, with the meanings of TileJacobian.
  std::vector<float> area_shift, area_turn, area_width, area_rim;

  PairsSetAside corners, ends;  ///< pairs with corners only, and pairs with an end
  DirectEnds direct_ends;
  int piece_count = 0;                      ///< pieces of the current pairs
  std::uint16_t piece_owner[kPieces + 16];  ///< pair of each piece, as counted in the group

  std::vector<std::uint32_t> live;   ///< the runs that have pairs
  std::vector<std::uint8_t> starts;  ///< one bit per pair: first of its run
  /// Run of each pair of this chunk and of the next, as its number among the live runs.
  std::uint32_t line_of[2][kChunk + 16];
  /// Constants of two SIMD vectors of live runs; run n is in column n % (2 lanes).
  alignas(64) float line[kLineConstants][kLines] = {};
  // Data of a pair that pass from one stage to the next.
  alignas(64) Lanes<kChunk> unit, alpha, gain, base, by_alpha, rim_light, moving_turn, moving_across, moving_along;
  /// Sums of a pair's pieces: V, shift, turn, width; first end, second end, radial; h across, h along.
  alignas(64) float total[kChunk + 16][12];
  alignas(64) Lanes<kChunk> area, origin_Y, a_shift, a_turn, a_first, a_second, a_rim, rim;

  // Pieces of the groove between breakpoints, and their results.
  alignas(64) Lanes<kPieces> t1, t2, top1, top2, bottom1, bottom2, on_first, on_second, hx, hy, hz, piece_alpha;
  alignas(64) Lanes<kPieces> front[6], lobes[7];
  alignas(64) Lanes<kPieces> curve, share;  ///< in place of h and alpha, if light is a curve (kernel/curves.h)
  alignas(64) Lanes<kPieces> piece_V, piece_shift, piece_turn, piece_width, piece_radial, piece_mean, piece_first;
  alignas(64) Lanes<kPieces> piece_across, piece_along;
};

/// Factors from a run's derivatives to those by the shared depth (um), width (um) and alpha. Depth and width set a
/// groove's rim, and the offset of a burr's middle (mm across).
struct RunUnits {
  float rim_by_depth = 0, aside_by_depth = 0;
  float scale_by_width = 0, rim_by_width = 0, aside_by_width = 0;
  float by_alpha = 1;
};

/// Derivatives per pixel, in the order of spread()'s sums: of light minus the plain face's light under grooves, mm^2.
enum PixelSlope : std::uint8_t {
  kByShift,                       ///< by all grooves shifted in x and y, mm
  kByHalf = kByShift + 2,         ///< by the half vector's x and y on the face; its z follows
  kByGrooves = kByHalf + 2,       ///< by M of x -> x + M (x - pixel's middle) for the grooves' middle lines, row by row
  kByFootprint = kByGrooves + 4,  ///< as kByGrooves for the footprint, less the light times M's trace
  kByDepth = kByFootprint + 4,
  kByWidth,
  kByAlpha,
  kPixelSlopes = 16
};

/// Numbers of gather() per run: dE by a shift of the scratch across (1 mm); its moment about the scratch's first end;
/// dE by each end moved along (1 mm). Moment / length is the derivative by the second end moved across. With material
/// also by log wt at a fixed rim, by the rim, by alpha, and a zero.
constexpr int run_gradients(KernelMode mode) { return mode == KernelMode::material ? 8 : 4; }

/// Kernels of one SIMD width.
struct TileKernels {
  /// Finds the pairs, without corners or shading.
  void (*find)(const TileTask& task, FoundPlaces& found);
  /// Fills buffers.sums, buffers.area_*, `pairs` and the arrays of `to` for the mode, except its ends.
  void (*evaluate)(const TileTask& task, const TilePlaces& places, TileBuffers& buffers, TilePairs& pairs,
                   const TileJacobian& to);
  /// After evaluate(), for pixels with nonzero `covered`: removes the light of the plain face, task.base. kTilePixels.
  void (*cover)(const TileTask& task, const TilePlaces& places, const float* covered, const TileBuffers& buffers,
                const TileJacobian& to);
  /// The backward pass: sums weight[place] times derivative over each run's pairs, run_gradients() numbers per run.
  void (*gather)(const TileTask& task, const TilePlaces& places, const float* weight, const TileJacobian& jacobian,
                 float* to);
  /// Adds the pairs' derivatives of each pixel to `to`: kPixelSlopes numbers per place. One RunUnits per run; half_x,
  /// half_y: the half vector of each place on the face.
  void (*spread)(const TileTask& task, const TilePlaces& places, const TileJacobian& jacobian, const RunUnits* units,
                 const float* half_x, const float* half_y, float* to);
};

/// Throws Error for a width that this machine does not support.
const TileKernels& tile_kernels(SimdWidth width);

}  // namespace burin
