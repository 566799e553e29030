#include "burin/render/fast/tiled_grid.h"

#include <tbb/parallel_for.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace burin {
namespace {

/// Corners this near to their lattice, as a share of a pixel, lie on it: what doubles leave of a board's grid.
constexpr double kOnLattice = 1e-9;

/// A pixel's corners, (column, row) from its middle.
constexpr std::array<std::array<double, 2>, 4> kAround{{{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}}};

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
    // visit(place, number of the corner, column and row of the corner in pixels from the first one's middle, mm).
    const auto each_corner = [&](const auto& visit) {
      each_pixel(t, [&](int x, int y, std::size_t place) {
        if (!index.has_footprint()[static_cast<std::size_t>(y) * width + x]) return;
        const auto q = footprint_corners_mm(grid, x, y);
        for (int k = 0; k < 4; ++k) {
          const std::size_t column = place % kTile, row = place / kTile;
          visit(
              place, k,
              Eigen::Vector3d(1, static_cast<double>(column) + kAround[k][0], static_cast<double>(row) + kAround[k][1]),
              q[k] - origin);
        }
      });
    };
    each_pixel(t, [&](int x, int y, std::size_t place) {
      if (!index.has_footprint()[static_cast<std::size_t>(y) * width + x]) return;
      inv_area[t * kTilePixels + place] =
          static_cast<float>(1 / std::abs(signed_area_mm2(footprint_corners_mm(grid, x, y))));
    });
    // Least squares.
    Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
    Eigen::Matrix<double, 3, 2> products = Eigen::Matrix<double, 3, 2>::Zero();
    each_corner([&](std::size_t, int, const Eigen::Vector3d& at, const Eigen::Vector2d& mm) {
      squares += at * at.transpose();
      products += at * mm.transpose();
    });
    if (!(squares(0, 0) > 0)) return;
    const Eigen::Matrix<double, 3, 2> fit = squares.ldlt().solve(products);
    lattice[t] = {fit(0, 0), fit(0, 1), fit(1, 0), fit(1, 1), fit(2, 0), fit(2, 1)};
    const double enough = kOnLattice * std::min(fit.row(1).norm(), fit.row(2).norm());
    each_corner([&](std::size_t place, int k, const Eigen::Vector3d& at, const Eigen::Vector2d& mm) {
      constexpr std::array<int, 4> kOffset{0, 1, TileCorners::kSide + 1, TileCorners::kSide};
      const Eigen::Vector2d off = mm - fit.transpose() * at;
      float* corner = corners[t].at[place / kTile * TileCorners::kSide + place % kTile + kOffset[k]];
      corner[0] = static_cast<float>(off.x());
      corner[1] = static_cast<float>(off.y());
      if (!(off.cwiseAbs().maxCoeff() <= enough)) on_lattice[t] = 0;
    });
  });
  if (std::find(on_lattice.begin(), on_lattice.end(), 0) == on_lattice.end()) corners = {};
}

}  // namespace burin
