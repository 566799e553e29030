// burin/render/fast/tile_kernel.h - the fast path's inner loop: what the scratches of one tile add to its pixels, with
// derivatives, in float packets.
//
// A tile's pairs (pixel, scratch) lie one scratch after the other. find() finds them; evaluate() adds up light and area
// of each pixel and makes one derivative of each pair's light and of the plain face's light that it covers; where a
// pixel turns out to be covered whole, cover() takes the plain face out again; gather() is the backward pass.
// Kernels of several SIMD widths do the same work; tile_kernels() picks one.
// Frames: burin/render/fast/tile.h. Source: docs/model.md 4 and 8.2 to 8.5; the integrals are
// burin/render/footprint/footprint_core.h.
//
// Along the groove, the footprint cut with the scratch is bounded by top(t) and bottom(t), both linear between
// breakpoints: the corners, and where edges meet the scratch's ends. With W the weight of footprint_core.h,
//   V = integral of (top - bottom) W dt,                    Dhat = (wt/2)^2 (alpha^2 / pi) V
//   dV/d(shift of the scratch by one unit across)  = integral of (top' - bottom') W dt
//   dV/d(turn of the scratch about t = 0, Y = 0)   = -integral of (top top' - bottom bottom') W dt + hy dV/dhx,
//       where a level that is a pixel's edge brings another -t, which cancels unless the other level is an end
//   dV/d(end moved along)                          = integral of W dt over where that end bounds the region
// Each piece between breakpoints is one evaluation of mean moments. Most pairs have a single one, [-rim, rim]: the
// pixel has no corner on the groove, and an end in it runs across the groove within it. They go straight through; the
// others are set aside and done afterwards, their pieces packed, so that packets stay full.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "burin/base/simd_width.h"
#include "burin/render/fast/tile.h"

namespace burin {

/// What a kernel computes: `value` only; `ends`: and derivatives by the scratch's ends; `material`: and by wt, d,
/// alpha.
enum class KernelMode : std::uint8_t { value, ends, material };

struct TileCurves;  // burin/render/fast/curve_tables.h

/// A pair that an end of its scratch bounds: derivatives by the ends moved along, a unit of Y, of what it adds to its
/// pixel and of the area that it covers.
struct EndPair {
  std::uint32_t pair = 0, run = 0;
  float first = 0, second = 0, area_first = 0, area_second = 0;
};

/// The pixels that a tile's runs touch: those of run r are at place[begin[r]] .. place[begin[r + 1] - 1].
struct TilePlaces {
  const std::uint32_t* begin = nullptr;  ///< one more than there are runs
  const std::uint16_t* place = nullptr;  ///< row * kTile + column; readable 16 beyond the last
};

/// The same in arrays that grow to the largest tile.
struct FoundPlaces {
  std::vector<std::uint32_t> begin;
  std::vector<std::uint16_t> place;

  TilePlaces places() const { return {begin.data(), place.data()}; }
};

/// Derivatives of what pairs add to their pixels, light minus the plain face's light that they cover: by a shift of one
/// unit of t, by a turn of one radian, by log wt with the rim held, by the rim, by alpha; and, where TileTask asks for
/// them, by the half vector's shares across and along the scratch, of which the third follows. Arrays reach a whole
/// packet beyond the last pair, and hold numbers there.
struct TileJacobian {
  float *shift = nullptr, *turn = nullptr, *width = nullptr, *rim = nullptr, *alpha = nullptr;
  float *h_across = nullptr, *h_along = nullptr;
  EndPair* ends = nullptr;
  std::size_t end_count = 0;
};

/// What evaluate() gives beside the Jacobian. Arrays grow to the largest tile and may be longer than what is in use.
struct TilePairs {
  std::vector<float> light;  ///< Dhat G, mm^2; only where it was asked for
  std::vector<EndPair> ends;
};

/// What evaluate() reads. `runs` must be readable one entry beyond the last.
struct TileTask {
  const TileLattice* lattice = nullptr;
  const TileCorners* corners = nullptr;  ///< null where all corners lie on the lattice
  const TileShading* shading = nullptr;
  const TileCurves* curves = nullptr;  ///< CurveKernels only, which need no shading
  const float* base = nullptr;         ///< the plain face's light a mm^2 of each pixel; not read for `value`
  const TileRun* runs = nullptr;
  RunShapes shapes;
  std::uint32_t run_count = 0;
  std::span<const TileBlock> blocks;
  const std::uint32_t* valid_rows = nullptr;  ///< a bit a pixel with a footprint; null where all have one
  KernelMode mode = KernelMode::value;
  bool keep_light = false;      ///< fills TilePairs::light
  bool by_half_vector = false;  ///< with `material`: fills TileJacobian::h_across and h_along
  /// The most of any tile so far. Buffers are made for so many, so that they need not grow when a thread comes to a
  /// larger tile.
  std::size_t most_runs = 0, most_pairs = 0;
};

/// What pairs need to know of their scratch: how t and Y change over the tile's lattice, in the units of TileRun. The
/// middle of pixel (column, row) is at t = mid + column * by column + row * by row.
///
/// Pixels may be much larger than the groove; then t runs over hundreds within a tile, while an edge that lies within
/// the groove must be known to 1e-6. So t is given in two parts. The `coarse` ones are multiples of one number, coarse
/// enough that small integers times them, and sums and halves of those, are exact in float; the `fine` ones are the
/// rests.
enum Line : std::uint8_t {
  kAcrossX,  // as in TileRun and RunShape
  kAcrossY,
  kPerMm,
  kUnit,  // 1 / kPerMm^2: mm^2 in a unit of t times one of Y
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
  kReachCoarse,  // how far a pixel reaches to either side of its middle in t
  kReachFine,
  kMidY,
  kOriginY,  // where pixels have lines of their own
  kColumnY,
  kRowY,
  kReachY,  // the same in Y
  kFarY,    // Y, from the middle, of the corner with the largest t
  kSteep,   // dY / dt of a pixel's sides, the larger first
  kFlat,
  kLineConstants
};

/// Pairs set aside: their numbers, and those of their runs among the live ones.
struct PairsSetAside {
  std::size_t count = 0;
  std::vector<std::uint32_t> pair, line;
};

/// One thread's buffers.
struct TileBuffers {
  static constexpr int kChunk = 128;  ///< pairs that go from stage to stage together
  static constexpr int kPieces = 512;
  static constexpr int kLines = 32;
  /// Rounded up to a whole packet, and an odd number of cache lines apart: entries of the same place must not all fall
  /// into the same set of the cache.
  template <int n>
  using Lanes = float[n + 16];
  /// Those of a chunk's direct pairs that an end bounds, as EndPair has them; `line`: of their runs among the live
  /// ones.
  struct DirectEnds {
    int count = 0;
    std::uint32_t pair[kChunk + 16], line[kChunk + 16];
    Lanes<kChunk> first, second, area_first, area_second;
  };

  alignas(64) float sums[2 * kTilePixels] = {};  ///< of each pixel: light, area (mm^2)
  /// Where all scratches have one shape, of each pixel: x and y of the half vector, G alpha^2 / pi, and the base; and
  /// d log(alpha^2 G) / d alpha.
  alignas(64) float lit[kTilePixels][4], lit_by_alpha[kTilePixels];
  /// Derivatives of area, as those of TileJacobian.
  std::vector<float> area_shift, area_turn, area_width, area_rim;

  PairsSetAside corners, ends;  ///< those with corners only, and those that an end meets
  DirectEnds direct_ends;
  int piece_count = 0;                      ///< pieces of those in work
  std::uint16_t piece_owner[kPieces + 16];  ///< the pair of each, as counted in the group

  std::vector<std::uint32_t> live;   ///< the runs that have pairs
  std::vector<std::uint8_t> starts;  ///< a bit a pair: it is the first of its run
  /// The run of each pair of this chunk and of the next, as its number among the live runs.
  std::uint32_t line_of[2][kChunk + 16];
  /// Constants of the live runs, two packets of them: those of number n are in column n % (2 lanes).
  alignas(64) float line[kLineConstants][kLines] = {};
  // What a pair carries from one stage to the next.
  alignas(64) Lanes<kChunk> unit, alpha, gain, base, by_alpha, rim_light, moving_turn, moving_across, moving_along;
  /// Sums of a pair's pieces: V, shift, turn, width; first end, second end, radial; h across, h along.
  alignas(64) float total[kChunk + 16][12];
  alignas(64) Lanes<kChunk> area, origin_Y, a_shift, a_turn, a_first, a_second, a_rim, rim;

  // Pieces of the groove between breakpoints, and what each gives.
  alignas(64) Lanes<kPieces> t1, t2, top1, top2, bottom1, bottom2, on_first, on_second, hx, hy, hz, piece_alpha;
  alignas(64) Lanes<kPieces> front[6], lobes[7];
  alignas(64) Lanes<kPieces> curve, share;  ///< instead of h and alpha, where light is a curve (kernel/curves.h)
  alignas(64) Lanes<kPieces> piece_V, piece_shift, piece_turn, piece_width, piece_radial, piece_mean, piece_first;
  alignas(64) Lanes<kPieces> piece_across, piece_along;
};

/// What a run's derivatives stand for in those by the shared depth (um), width (um) and alpha: a groove's rim lies
/// where depth and width say, a burr's middle beside it (mm across).
struct RunUnits {
  float rim_by_depth = 0, aside_by_depth = 0;
  float scale_by_width = 0, rim_by_width = 0, aside_by_width = 0;
  float by_alpha = 1;
};

/// Derivatives of a pixel, in the order in which spread() adds them up: of light less the plain face's that is covered,
/// mm^2.
enum PixelSlope : std::uint8_t {
  kByShift,                       ///< by all grooves shifted in x and y, mm
  kByHalf = kByShift + 2,         ///< by the half vector's x and y on the face, its z following
  kByGrooves = kByHalf + 2,       ///< by M of x -> x + M (x - pixel's middle) for the grooves' middle lines, row by row
  kByFootprint = kByGrooves + 4,  ///< the same for the footprint, less the light times M's trace
  kByDepth = kByFootprint + 4,
  kByWidth,
  kByAlpha,
  kPixelSlopes = 16
};

/// What gather() gives for each run: dE by a shift of the scratch across (1 mm), its moment about the scratch's first
/// end (so that moment / length is by its second end moved across), dE by either end moved along (1 mm); with material
/// also by log wt with the rim held, by the rim, by alpha, and a zero.
constexpr int run_gradients(KernelMode mode) { return mode == KernelMode::material ? 8 : 4; }

/// The kernels of one width.
struct TileKernels {
  /// Finds the pairs. Reads neither corners nor shading.
  void (*find)(const TileTask& task, FoundPlaces& found);
  /// Fills buffers.sums, buffers.area_*, `pairs` and the arrays of `to` that the mode has, but not its ends.
  void (*evaluate)(const TileTask& task, const TilePlaces& places, TileBuffers& buffers, TilePairs& pairs,
                   const TileJacobian& to);
  /// After evaluate(): nothing is left of the plain face in pixels where `covered` is not 0 but task.base; kTilePixels.
  void (*cover)(const TileTask& task, const TilePlaces& places, const float* covered, const TileBuffers& buffers,
                const TileJacobian& to);
  /// The backward pass: sums over each run's pairs of weight[place] times derivative, run_gradients() numbers a run.
  void (*gather)(const TileTask& task, const TilePlaces& places, const float* weight, const TileJacobian& jacobian,
                 float* to);
  /// What the pairs' derivatives add up to in each pixel: kPixelSlopes numbers for each place, added to `to`. One
  /// RunUnits a run; half_x, half_y: the half vector of each place on the face.
  void (*spread)(const TileTask& task, const TilePlaces& places, const TileJacobian& jacobian, const RunUnits* units,
                 const float* half_x, const float* half_y, float* to);
};

/// Throws Error for a width that does not run here.
const TileKernels& tile_kernels(SimdWidth width);

}  // namespace burin
