// burin/render/fast/pixel_slopes.h - what the grooves that a pixel sees add up to, and how that changes, from the fast
// path's packets: the fast twin of exact/exact_sums.h. docs/model.md 8.7. Frame: board, mm.
//
// Pairs are summed by what can happen to their pixel as a whole: grooves shift and are mapped linearly about its
// middle, the footprint is, its half vector moves. So footprints that are no parallelograms any more are left out, and
// that a scratch's end, square across it, is not after a linear map.
#pragma once

#include <Eigen/Core>
#include <array>

#include "burin/render/fast/tile_kernel.h"
#include "burin/render/groove_sums.h"
#include "burin/render/pixel_shading.h"

namespace burin {

/// Of one pixel.
struct PixelSlopes {
  float light = 0, area_mm2 = 0;  ///< light: in units of `unit` below times mm^2
  std::array<float, kPixelSlopes> by{};
};

/// `p`: a pixel that is lit and seen; `corners_mm` and `area_mm2` are its footprint's; `unit`: what light of 1 stands
/// for; `alpha`: the shared roughness, at which shadowing follows the cosines.
GrooveSums groove_sums(const PixelSlopes& slopes, double unit, const PixelShading& p,
                       const std::array<Eigen::Vector2d, 4>& corners_mm, double area_mm2, double alpha);

}  // namespace burin
