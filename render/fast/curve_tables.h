// burin/render/fast/curve_tables.h - light that depends on the place across a groove as a curve: what surroundings
// send, tabulated over the directions of grooves and over the picture (burin/render/surroundings/make_curve_tables.h),
// and a tile's share of it. docs/model.md 10.8 to 10.12. Frames: burin/render/fast/tile.h.
//
// A curve is R over t, kept as its second integral from t = 0 with two derivatives at evenly spaced nodes: between two
// nodes that is one polynomial of the fifth degree, and all that a piece of a groove asks for is differences of it.
#pragma once

#include <tbb/cache_aligned_allocator.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace burin {

/// Numbers of curves, which begin with a cache line: packets that lie across two cost twice.
using CurveFloats = std::vector<float, tbb::cache_aligned_allocator<float>>;

constexpr int kCurveNode = 3;  ///< floats of a curve's node

/// Curves for the directions of grooves (azimuth of the unit vector across them, j * 180 / directions degrees), for
/// places of the picture, for roughnesses. A groove that is turned by 180 degrees has the same curve the other way
/// round.
struct CurveTables {
  int half_count = 1;  ///< nodes lie at t = -half_count * step .. half_count * step
  float step = 1;
  int row_floats = 0;  ///< a curve: 3 numbers a node (second integral, step * integral, step^2 R / 2), padded to 16
  int directions = 0;  ///< rows of a place: from direction -1 to directions + 1
  /// Places, evenly spread over the picture, and whether light between them follows from 4 x 4 of them (or 2 x 2).
  int columns = 1, rows = 1;
  double columns_per_pixel = 0, rows_per_pixel = 0;
  bool cubic = false;
  std::vector<float> log_alpha;  ///< of the roughnesses, ascending: one, or three and more
  int parts = 1;                 ///< of the cross-section, each with all roughnesses (SectionPart, groove_strips.h)
  double lean_per_pixel = 0;     ///< by how much the half vector turns from a pixel to the next

  /// Whether that is so little over a tile, for the least roughness, that light is linear over it; and whether places
  /// are the corners of the tiles then, at column_corners x row_corners, instead of evenly spread.
  bool linear_over_tiles = false, of_tiles = false;
  /// Pixels where tiles meet, with the picture's first and last.
  std::vector<float> column_corners, row_corners;

  /// The curves, of each number the share of its largest: [part][roughness][place row][place column][direction +
  /// 1][number].
  /// In half the memory of floats, which is what they wait for; 3e-5 of the brightest curve is below what tables do.
  std::vector<std::int16_t, tbb::cache_aligned_allocator<std::int16_t>> data;
  CurveFloats unit;  ///< what 1 stands for, of each number of a curve

  std::size_t tables() const { return parts * log_alpha.size(); }
  std::size_t place_floats() const { return static_cast<std::size_t>(directions + 3) * row_floats; }
};

/// Where a run's curves are. They are made at a few places along it, its knots, between which light is linear.
struct RunCurve {
  float number = 1;   ///< of its first knot's curve, from 1; negative: t runs the other way
  float first_Y = 0;  ///< Y of that knot (as in TileRun)
  float per_Y = 0;    ///< knots; of a lone knot, by what share all of its light grows
  float last = -1;    ///< steps between its knots, less 1; -1 for a lone knot
};

/// The curves of a tile's runs. A knot's curves lie one after the other: R, dR by the groove's turn, dR by alpha; under
/// a lamp dR by the half vector's shares across and along the groove, too.
struct TileCurves {
  std::vector<RunCurve> runs;  ///< readable a packet beyond the last
  CurveFloats knots;
  std::size_t knot_floats = 0, curve_floats = 0;
  int half_count = 1;
  float step = 1;

  /// Room for so many, kept. Not inline: what calls it is compiled for machines that others are not.
  void grow_runs(std::size_t count);
  void grow_knots(std::size_t floats);
  void grow_rows(std::size_t floats);

  // What curves need of each run: numbers one after the other, line_stride apart (kernel/run_curves.h).
  static constexpr int kMostLines = 20;
  std::vector<float> lines;
  std::size_t line_stride = 0;

  // A tile's own rows of the tables, as they are asked for (kernel/run_curves.h), and four numbers of each; or the
  // light of a lamp's knot (kernel/lamp_knots.h).
  CurveFloats rows;
  std::vector<float> row_light;
  std::vector<std::uint8_t> row_made, row_wanted;
  void start_rows(std::size_t count, std::size_t floats);
};

}  // namespace burin
