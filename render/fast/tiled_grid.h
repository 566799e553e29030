// burin/render/fast/tiled_grid.h - a grid of footprints as input of the fast path: divided into tiles, in float. Made
// once per grid and shared by all of its views. Frame: burin/render/fast/tile.h.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "burin/render/fast/pixel_index.h"
#include "burin/render/fast/tile.h"
#include "burin/scene/footprint_grid.h"

namespace burin {

/// Immutable.
struct TiledGrid {
  /// Keeps no reference to `grid`.
  explicit TiledGrid(const FootprintGrid& grid);

  int width = 0, height = 0;
  PixelIndex index;
  std::vector<TileLattice> lattice;  ///< by tile
  std::vector<TileCorners> corners;  ///< by tile; empty if all corners are on their lattices, as on boards
  std::vector<float> inv_area;       ///< 1 / mm^2, by tile * kTilePixels + place in the tile; 0 without a footprint

  std::size_t tiles() const { return lattice.size(); }
  /// Approximate memory.
  std::size_t bytes() const {
    return lattice.size() *
               (sizeof(TileLattice) + sizeof(GridTile) + kTile * sizeof(std::uint32_t) + sizeof(TileBlock)) +
           corners.size() * sizeof(TileCorners) + inv_area.size() * sizeof(float) + index.has_footprint().size();
  }

  /// visit(x, y of the picture, place in the tile) for the pixels of a tile.
  template <typename Visit>
  void each_pixel(std::size_t t, const Visit& visit) const {
    each_row(t, [&](int n, std::size_t place, int x, int y) {
      for (int k = 0; k < n; ++k) visit(x + k, y, place + k);
    });
  }

  /// visit(pixels, place in the tile of the first, x, y of the picture) for the rows of a tile.
  template <typename Visit>
  void each_row(std::size_t t, const Visit& visit) const {
    const int x0 = static_cast<int>(t % index.tiles_x()) * kTile, y0 = static_cast<int>(t / index.tiles_x()) * kTile;
    const int x1 = x0 + kTile < width ? x0 + kTile : width, y1 = y0 + kTile < height ? y0 + kTile : height;
    for (int y = y0; y < y1; ++y) visit(x1 - x0, static_cast<std::size_t>(y - y0) * kTile, x0, y);
  }
};

}  // namespace burin
