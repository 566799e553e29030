#include "render/tiled_grid.h"

#include <tbb/parallel_for.h>

#include <array>
#include <cmath>

namespace burin {

TiledGrid::TiledGrid(const FootprintGrid& grid)
    : width(grid.width()),
      height(grid.height()),
      index(grid),
      corners(index.tiles().size()),
      inv_area(corners.size() * kTilePixels, 0.0F) {
  tbb::parallel_for(std::size_t{0}, tiles(), [&](std::size_t t) {
    const Eigen::Vector2d& origin = index.tiles()[t].origin_mm;
    each_pixel(t, [&](int x, int y, std::size_t place) {
      if (!index.has_footprint()[static_cast<std::size_t>(y) * width + x]) return;
      const auto q = footprint_corners_mm(grid, x, y);
      constexpr std::array<int, 4> kAround{0, 1, TileCorners::kSide + 1, TileCorners::kSide};
      for (int k = 0; k < 4; ++k) {
        float* corner = corners[t].at[place / kTile * TileCorners::kSide + place % kTile + kAround[k]];
        corner[0] = static_cast<float>(q[k].x() - origin.x());
        corner[1] = static_cast<float>(q[k].y() - origin.y());
      }
      inv_area[t * kTilePixels + place] = static_cast<float>(1 / std::abs(signed_area_mm2(q)));
    });
  });
}

}  // namespace burin
