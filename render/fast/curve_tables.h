// burin/render/fast/curve_tables.h - light as a curve over the position across a groove. Tables hold the curves of an
// environment map over directions of grooves and the picture (burin/render/surroundings/make_curve_tables.h); each tile
// has its own curves. docs/model.md 10.8 to 10.12. Frames: burin/render/fast/tile.h.
//
// A curve is R over t. It is stored as its second integral from t = 0 with two derivatives at evenly spaced nodes.
// Between two nodes the second integral is one polynomial of the fifth degree. A piece of a groove needs only
// differences of it.
#pragma once

#include <tbb/cache_aligned_allocator.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace burin {

/// Numbers of curves, aligned to cache lines: a SIMD vector across two lines costs twice.
using CurveFloats = std::vector<float, tbb::cache_aligned_allocator<float>>;

constexpr int kCurveNode = 3;  ///< floats of a curve's node

/// Curves by direction of groove (azimuth of the unit vector across it, j * 180 / directions degrees), place in the
/// picture and roughness. A groove turned by 180 degrees has the same curve in reverse.
struct CurveTables {
  int half_count = 1;  ///< t of the nodes: -half_count * step .. half_count * step
  float step = 1;
  /// length of a curve: 3 numbers per node (second integral, step * integral, step^2 R / 2), padded to 16
  int row_floats = 0;
  int directions = 0;  ///< rows per place: from direction -1 to directions + 1
  /// Places, evenly spread over the picture. `cubic`: light between them interpolates 4 x 4 of them, else 2 x 2.
  int columns = 1, rows = 1;
  double columns_per_pixel = 0, rows_per_pixel = 0;
  bool cubic = false;
  std::vector<float> log_alpha;  ///< of the roughnesses, ascending: one, or at least three
  int parts = 1;                 ///< of the cross-section, each with all roughnesses (SectionPart, groove_strips.h)
  double lean_per_pixel = 0;     ///< turn of the half vector per pixel

  /// `linear_over_tiles`: this turn is small enough for linear light over a tile, at the least roughness. `of_tiles`:
  /// places are then the corners of the tiles (column_corners x row_corners), else an even grid.
  bool linear_over_tiles = false, of_tiles = false;
  /// Pixels at tile boundaries, with the picture's first and last.
  std::vector<float> column_corners, row_corners;

  /// The curves, each number as a share of its largest: [part][roughness][place row][place column][direction +
  /// 1][number].
  /// Entries have 16 bits, because memory bandwidth limits the speed. The rounding of 3e-5 of the brightest curve is
  /// below the tables' error.
  std::vector<std::int16_t, tbb::cache_aligned_allocator<std::int16_t>> data;
  CurveFloats unit;  ///< scale of each number of a curve

  std::size_t tables() const { return parts * log_alpha.size(); }
  std::size_t place_floats() const { return static_cast<std::size_t>(directions + 3) * row_floats; }
};

/// Position of a run's curves. A run has curves at a few positions along it, its knots; light is linear in between.
struct RunCurve {
  float number = 1;   ///< of its first knot's curve, from 1; negative: t is reversed
  float first_Y = 0;  ///< Y of that knot (as in TileRun)
  float per_Y = 0;    ///< knots per Y; for a single knot, the relative growth of all its light per Y
  float last = -1;    ///< steps between its knots, less 1; -1 for a single knot
};

/// The curves of a tile's runs. A knot's curves follow one another: R, dR by the groove's turn, dR by alpha. Under a
/// lamp dR by the half vector's components across and along the groove follow.
struct TileCurves {
  std::vector<RunCurve> runs;  ///< readable one SIMD vector beyond the last
  CurveFloats knots;
  std::size_t knot_floats = 0, curve_floats = 0;
  int half_count = 1;
  float step = 1;

  /// Grow the arrays and keep them. Not inline, because callers are compiled for other instruction sets.
  void grow_runs(std::size_t count);
  void grow_knots(std::size_t floats);
  void grow_rows(std::size_t floats);

  // Constants of each run for its curves: successive numbers are line_stride apart (kernel/run_curves.h).
  static constexpr int kMostLines = 20;
  std::vector<float> lines;
  std::size_t line_stride = 0;

  // Rows of the tables for this tile, made on demand (kernel/run_curves.h), with four numbers each. Under a lamp: the
  // light of a knot (kernel/lamp_knots.h).
  CurveFloats rows;
  std::vector<float> row_light;
  std::vector<std::uint8_t> row_made, row_wanted;
  void start_rows(std::size_t count, std::size_t floats);
};

}  // namespace burin
