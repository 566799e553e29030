// burin/render/fast/tile.h - the fast path's pieces of a picture: tiles of 32 x 32 pixels, and what a scratch is within
// one. Frame: board xy in mm from the tile's origin, so that float keeps its digits. docs/model.md 8.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace burin {

inline constexpr int kTile = 32;  ///< pixels along a side
inline constexpr int kTilePixels = kTile * kTile;

/// The affine lattice nearest to the corners of a tile's footprints. Those of pixel (column, row) are (column, row),
/// (column + 1, row), (column + 1, row + 1), (column, row + 1); either way round. x, y in mm from the tile's origin.
struct TileLattice {
  double first_x = 0, first_y = 0;    ///< the middle of pixel (0, 0)
  double column_x = 0, column_y = 0;  ///< from a column to the next
  double row_x = 0, row_y = 0;
};

/// How far a tile's corners are off its lattice: x, y in mm.
struct alignas(64) TileCorners {
  static constexpr int kSide = kTile + 1;
  float at[kSide * kSide][2] = {};
};

/// How a tile's pixels are lit and seen: x and y of the half vector in the face's frame; tan^2 of wi and wo. Small
/// enough, with the corners, to stay in a core's first cache.
struct alignas(64) TileShading {
  float at[kTilePixels][4] = {};
};

/// A straight groove seen from a tile: an affine map from there to its own units, t = 2 x / wt across it and
/// Y = 2 y / wt along it, Y = 0 at the foot of the tile's origin. Across is (d.y, -d.x) for a direction d.
struct TileRun {
  float across_x = 1, across_y = 0;     ///< unit vector across it
  float t_origin = 0;                   ///< t of the tile's origin
  float first_end = 0, second_end = 0;  ///< Y of its ends
  /// across_x, across_y and t_origin less their values in float: pixels may be much larger than the groove.
  float across_x_rest = 0, across_y_rest = 0, t_origin_rest = 0;
};

/// Width, rim and roughness of a run's groove. Most boards have one for all.
struct RunShape {
  float per_mm = 1;  ///< 2 / wt
  float rim = 1;     ///< the groove reaches over |t| <= rim
  float alpha = 1;
  float part = 0;  ///< of a cross-section, as SectionPart (groove_strips.h) counts them
};

/// The shapes of runs: one each, or one for all.
struct RunShapes {
  const RunShape* shapes = nullptr;
  bool shared = true;

  const RunShape& operator[](std::size_t run) const { return shapes[shared ? 0 : run]; }
};

/// Pixels x0 .. x1 - 1, y0 .. y1 - 1 of a tile, and a projective map that takes their corners to the tile's pixel
/// lattice (corner (c, r) is at (c, r)) within error_px.
struct TileBlock {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  std::array<float, 9> lattice_from_mm{};    ///< row-major, homogeneous
  std::array<float, 2> low_mm{}, high_mm{};  ///< box around their footprints
  float error_px = 0;
  bool by_box = false;  ///< no map: any scratch that meets the box touches all of its pixels
};

}  // namespace burin
