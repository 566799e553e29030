// burin/render/fast/pairs.h - which pixels each scratch touches.
//
// A scratch is a strip of the board: |x| <= half width, 0 <= y <= length. A pixel is touched when its footprint, the
// quadrilateral of its corners, shares a point with the strip. No such pair is missed, for any grid: perspective, lens
// distortion, bowed faces, pixels larger or smaller than the groove. A few pixels that only nearly touch are reported
// too.
//
// How: tile by tile (pixel_index.h). Frame: board xy, mm. docs/model.md 8.1.
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

/// Appends the spans of a grid that the strip touches. Each pixel at most once; pixels without a footprint never.
void find_spans(const PixelIndex& index, const Strip& strip, std::vector<PixelSpan>& spans);

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
std::vector<Strip> strips_of(const Scratches& scratches, double shared_width_um, const Material& material);

}  // namespace burin
