// burin/render/fast/pairs.h - pixels that each scratch touches.
//
// A scratch is a strip of the board: |x| <= half width, 0 <= y <= length. It touches a pixel if the pixel's footprint,
// the quadrilateral of its corners, shares a point with the strip. The search misses no pair for any grid: perspective,
// lens distortion, bowed faces, pixels larger or smaller than the groove. It also reports a few pixels that almost
// touch.
//
// Method: tile by tile (pixel_index.h). Frame: board xy, mm. docs/model.md 8.1.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "burin/render/fast/pixel_index.h"
#include "burin/scene/material.h"
#include "burin/scene/scratches.h"

namespace burin {

/// Pixels begin .. end - 1 of one row.
struct PixelSpan {
  int row = 0, begin = 0, end = 0;
};

/// Appends the spans of a grid that the strip touches. Each pixel occurs at most once; pixels without a footprint
/// never.
void find_spans(const PixelIndex& index, const Strip& strip, std::vector<PixelSpan>& spans);

/// All pairs, by pixel: pixel i has scratch[begin[i]] .. scratch[begin[i + 1] - 1], ascending.
struct PixelPairs {
  std::vector<std::size_t> begin;  ///< width * height + 1
  std::vector<std::uint32_t> scratch;
};
PixelPairs find_pairs(const PixelIndex& index, int width, int height, const std::vector<Strip>& strips);

/// Throws Error with the first scratch that has a non-finite coordinate, or a width, depth or alpha that is not
/// positive. Throws Error also for arrays of different sizes.
void check_scratches(const Scratches& scratches);

/// The strips of scratches. Shared width and depth serve scratches without their own.
std::vector<Strip> strips_of(const Scratches& scratches, double shared_width_um, const Material& material);

}  // namespace burin
