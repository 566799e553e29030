// burin/render/fast/tile.h - tiles of 32 x 32 pixels of the fast path, and the representation of a scratch within one.
// Frame: board xy in mm from the tile's origin, so that float keeps its digits. docs/model.md 8.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace burin {

inline constexpr int kTile = 32;  ///< pixels along a side
inline constexpr int kTilePixels = kTile * kTile;

/// The affine lattice nearest to the corners of a tile's footprints. Pixel (column, row) has the corners (column, row),
/// (column + 1, row), (column + 1, row + 1), (column, row + 1), in either orientation. x, y in mm from the tile's
/// origin.
struct TileLattice {
  double first_x = 0, first_y = 0;    ///< the middle of pixel (0, 0)
  double column_x = 0, column_y = 0;  ///< from a column to the next
  double row_x = 0, row_y = 0;
};

/// Offsets of a tile's corners from its lattice: x, y in mm.
struct alignas(64) TileCorners {
  static constexpr int kSide = kTile + 1;
  float at[kSide * kSide][2] = {};
};

/// Light and view of a tile's pixels: x and y of the half vector in the face's frame; tan^2 of wi and wo. With the
/// corners it fits into a core's first-level cache.
struct alignas(64) TileShading {
  float at[kTilePixels][4] = {};
};

/// A straight groove in a tile: an affine map from the tile to the groove's units. t = 2 x / wt is across it and Y = 2
/// y / wt along it, with Y = 0 at the foot of the tile's origin. Across is (d.y, -d.x) for a direction d.
struct TileRun {
  float across_x = 1, across_y = 0;     ///< unit vector across it
  float t_origin = 0;                   ///< t of the tile's origin
  float first_end = 0, second_end = 0;  ///< Y of its ends
  /// across_x, across_y and t_origin minus their float values, because pixels may be much larger than the groove.
  float across_x_rest = 0, across_y_rest = 0, t_origin_rest = 0;
};

/// Width, rim and roughness of a run's groove. Most boards have one shape for all.
struct RunShape {
  float per_mm = 1;  ///< 2 / wt
  float rim = 1;     ///< the groove reaches over |t| <= rim
  float alpha = 1;
  float part = 0;  ///< part of a cross-section, with the values of SectionPart (groove_strips.h)
};

/// The shapes of runs: one each, or one for all.
struct RunShapes {
  const RunShape* shapes = nullptr;
  bool shared = true;

  const RunShape& operator[](std::size_t run) const { return shapes[shared ? 0 : run]; }
};

/// Pixels x0 .. x1 - 1, y0 .. y1 - 1 of a tile, and a projective map of their corners to the tile's pixel lattice.
/// Corner (c, r) maps to (c, r) within error_px.
struct TileBlock {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  std::array<float, 9> lattice_from_mm{};    ///< row-major, homogeneous
  std::array<float, 2> low_mm{}, high_mm{};  ///< box around their footprints
  float error_px = 0;
  bool by_box = false;  ///< no map: a scratch that meets the box touches all of its pixels
};

}  // namespace burin
