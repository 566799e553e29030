// render/pairs.h - which pixels each scratch touches.
//
// A scratch is a strip of the board: |x| <= half width, 0 <= y <= length. A pixel is touched when its footprint, the
// quadrilateral of its corners, shares a point with the strip. No such pair is missed, for any grid: perspective, lens
// distortion, bowed faces, pixels larger or smaller than the groove. A few pixels that only nearly touch are reported
// too.
//
// How: the grid is cut into blocks of pixels small enough that an affine map takes their footprints' corners to the
// pixel lattice within kBlockError_px (found from the corners, so it needs no camera). The strip is drawn in a block
// through its map, every pixel widened by what the map was measured to be wrong: this can only add pixels. Where the
// grid is a homography throughout, one block with that homography is enough. Blocks are found through a quadtree.
// Frame: board xy, mm. DESIGN 3.5, 7.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "render/footprint_grid.h"
#include "render/scratches.h"

namespace burin {

/// A scratch on the board: all points within half_width_mm of the line between its ends, ends cut square.
struct Strip {
  Eigen::Vector2d p0_mm{0, 0}, p1_mm{0, 0};
  double half_width_mm = 0;
};

/// Pixels begin .. end - 1 of one row.
struct PixelSpan {
  int row = 0, begin = 0, end = 0;
};

/// The blocks of a grid. Built once a grid; the grid may go.
class PixelIndex {
 public:
  explicit PixelIndex(const FootprintGrid& grid);

  /// Appends the spans that the strip touches. Each pixel at most once; pixels without a footprint never.
  void find(const Strip& strip, std::vector<PixelSpan>& spans) const;

  /// 1 where a pixel has a footprint: finite corners, an area above 0. Row-major.
  const std::vector<std::uint8_t>& has_footprint() const { return valid_; }

 private:
  struct Block {
    int x0 = 0, y0 = 0, x1 = 0, y1 = 0;     // pixels x0 .. x1 - 1, y0 .. y1 - 1
    Eigen::Vector2d low{0, 0}, high{0, 0};  // box around their footprints, mm
    int child = -1;                         // first of child_count; -1: a leaf
    int child_count = 0;
    bool all_valid = false;
    bool by_box = false;  // a leaf whose map would be singular: its box decides
    bool projective = false;
    Eigen::Matrix3d pixel_from_board = Eigen::Matrix3d::Zero();  // lattice: corner (c, r) is at (c, r)
    double error_px = 0;
    double w_min = 0;  // least third homogeneous coordinate among its corners
  };

  void build(const FootprintGrid& grid, int block);
  bool measure(const FootprintGrid& grid, Block& block) const;
  void draw(const Block& block, const Strip& strip, std::vector<PixelSpan>& spans) const;
  void emit(const Block& block, int row, int begin, int end, std::vector<PixelSpan>& spans) const;

  int width_ = 0, height_ = 0;
  std::vector<std::uint8_t> valid_;
  std::vector<Block> blocks_;  // blocks_[0] is the root
};

/// All pairs, by pixel: those of pixel i are scratch[begin[i]] .. scratch[begin[i + 1] - 1], ascending.
struct PixelPairs {
  std::vector<std::size_t> begin;  ///< width * height + 1
  std::vector<std::uint32_t> scratch;
};
PixelPairs find_pairs(const PixelIndex& index, int width, int height, const std::vector<Strip>& strips);

/// Throws Error naming the first scratch that has a coordinate that is not finite, or a width, depth or alpha that is
/// not positive, or arrays whose sizes differ.
void check_scratches(const Scratches& scratches);

/// The strips of scratches; width and depth shared where they carry none.
std::vector<Strip> strips_of(const Scratches& scratches, double shared_width_um, double shared_depth_um);

}  // namespace burin
