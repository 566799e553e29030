#include "burin/render/fast/tiled_grid.h"

#include <tbb/parallel_for.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace burin {
namespace {

/// Corners within this distance of their lattice, as a share of a pixel, are on it: rounding of a board's grid.
constexpr double kOnLattice = 1e-9;

}  // namespace

TiledGrid::TiledGrid(const FootprintGrid& grid)
    : width(grid.width()),
      height(grid.height()),
      index(grid),
      lattice(index.tiles().size()),
      corners(lattice.size()),
      inv_area(lattice.size() * kTilePixels, 0.0F) {
  std::vector<std::uint8_t> on_lattice(tiles(), 1);
  tbb::parallel_for(std::size_t{0}, tiles(), [&](std::size_t t) {
    const Eigen::Vector2d& origin = index.tiles()[t].origin_mm;
    // Number of the tile's footprints at each corner.
    std::array<int, TileCorners::kSide * TileCorners::kSide> shared{};
    each_pixel(t, [&](int x, int y, std::size_t place) {
      if (!index.has_footprint()[static_cast<std::size_t>(y) * width + x]) return;
      inv_area[t * kTilePixels + place] =
          static_cast<float>(1 / std::abs(signed_area_mm2(footprint_corners_mm(grid, x, y))));
      const std::size_t corner = place / kTile * TileCorners::kSide + place % kTile;
      for (const std::size_t around :
           {corner, corner + 1, corner + TileCorners::kSide + 1, corner + TileCorners::kSide})
        ++shared[around];
    });
    // visit(index of the corner, number of footprints, column and row in pixels from the first one's middle, mm).
    const int x0 = static_cast<int>(t % index.tiles_x()) * kTile, y0 = static_cast<int>(t / index.tiles_x()) * kTile;
    const auto each_corner = [&](const auto& visit) {
      for (int row = 0; row < TileCorners::kSide; ++row)
        for (int column = 0; column < TileCorners::kSide; ++column) {
          const int corner = row * TileCorners::kSide + column;
          if (shared[corner] == 0) continue;
          const std::size_t of_grid = static_cast<std::size_t>(y0 + row) * (width + 1) + x0 + column;
          visit(corner, shared[corner], column - 0.5, row - 0.5,
                Eigen::Vector2d(grid.corner_x_mm[of_grid], grid.corner_y_mm[of_grid]) - origin);
        }
    };
    // Least squares.
    Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
    Eigen::Matrix<double, 3, 2> products = Eigen::Matrix<double, 3, 2>::Zero();
    each_corner([&](int, int weight, double column, double row, const Eigen::Vector2d& mm) {
      const Eigen::Vector3d at(1, column, row), weighted = weight * at;
      squares += weighted * at.transpose();
      products += weighted * mm.transpose();
    });
    if (!(squares(0, 0) > 0)) return;
    const Eigen::Matrix<double, 3, 2> fit = squares.ldlt().solve(products);
    lattice[t] = {fit(0, 0), fit(0, 1), fit(1, 0), fit(1, 1), fit(2, 0), fit(2, 1)};
    const double enough = kOnLattice * std::min(fit.row(1).norm(), fit.row(2).norm());
    each_corner([&](int number, int, double column, double row, const Eigen::Vector2d& mm) {
      const Eigen::Vector2d off = mm - fit.transpose() * Eigen::Vector3d(1, column, row);
      float* corner = corners[t].at[number];
      corner[0] = static_cast<float>(off.x());
      corner[1] = static_cast<float>(off.y());
      if (!(off.cwiseAbs().maxCoeff() <= enough)) on_lattice[t] = 0;
    });
  });
  if (std::find(on_lattice.begin(), on_lattice.end(), 0) == on_lattice.end()) corners = {};
}

}  // namespace burin
