// burin/render/fast/pixel_index.h - a grid of pixels divided into tiles, with a search for the tiles of a strip.
//
// A tile (burin/render/fast/tile.h) is one block, or several if one map is too inaccurate. A block has a projective map
// from its footprints' corners to the pixel lattice, with an error up to kBlockError_px measured at every corner. So no
// camera is needed. One map of the whole grid, also with a known error, finds the tiles that a strip may touch. Without
// such a map (folded or split grids), the tiles' boxes find them. In a tile the block's map rasterizes the strip, with
// every pixel widened by the map's error, which can only add pixels. Frame: board xy, mm. docs/model.md 8.1.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "burin/render/fast/tile.h"
#include "burin/scene/footprint_grid.h"

namespace burin {

/// A scratch on the board: all points within half_width_mm of the line between its ends, with square ends.
struct Strip {
  Eigen::Vector2d p0_mm{0, 0}, p1_mm{0, 0};
  double half_width_mm = 0;
};

/// One tile of a grid. Tiles without any footprint have no blocks.
struct GridTile {
  Eigen::Vector2d origin_mm{0, 0};
  std::uint32_t block_begin = 0, block_end = 0;
  bool all_valid = false;  ///< every pixel of the grid in the tile has a footprint
};

/// A map of a whole grid to its pixel lattice, with an error up to error_px at every footprint's corner.
struct GridMap {
  bool exists = false, affine = false;
  Eigen::Matrix3d lattice_from_board = Eigen::Matrix3d::Identity();
  double error_px = 0;
  double w_min = 0;  ///< least third homogeneous coordinate among the corners
};

/// The tiles of a grid. Built once per grid, without a reference to it.
class PixelIndex {
 public:
  explicit PixelIndex(const FootprintGrid& grid);

  int tiles_x() const { return tiles_x_; }
  int tiles_y() const { return tiles_y_; }
  std::span<const GridTile> tiles() const { return tiles_; }  ///< row-major
  std::span<const TileBlock> blocks(const GridTile& tile) const {
    return std::span(blocks_).subspan(tile.block_begin, tile.block_end - tile.block_begin);
  }

  /// Bit c of row r: the pixel of the tile has a footprint. Null if all pixels have one.
  const std::uint32_t* valid_rows(std::size_t tile) const {
    return tiles_[tile].all_valid ? nullptr : valid_rows_[tile].data();
  }

  const GridMap& map() const { return map_; }

  /// Appends the tiles that a strip may touch, in ascending order. `across_mm`: half its width across it.
  void find_tiles(const Eigen::Vector2d& p0_mm, const Eigen::Vector2d& p1_mm, const Eigen::Vector2d& across_mm,
                  std::vector<std::uint32_t>& tiles) const;

  /// 1 for pixels with a footprint: finite corners and a positive area. Row-major.
  const std::vector<std::uint8_t>& has_footprint() const { return valid_; }

 private:
  void map_whole_grid(const FootprintGrid& grid);
  void add_blocks(const FootprintGrid& grid, int x0, int y0, int x1, int y1, const Eigen::Vector2d& origin_mm, int left,
                  int top);

  int width_ = 0, height_ = 0, tiles_x_ = 0, tiles_y_ = 0;
  std::vector<std::uint8_t> valid_;
  std::vector<GridTile> tiles_;
  std::vector<std::array<std::uint32_t, kTile>> valid_rows_;  // by tile
  std::vector<TileBlock> blocks_;
  GridMap map_;
};

}  // namespace burin
