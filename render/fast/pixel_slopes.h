// burin/render/fast/pixel_slopes.h - sums over the grooves of a pixel with their derivatives, from the fast path's SIMD
// vectors. exact/exact_sums.h is its double-precision reference. docs/model.md 8.7. Frame: board, mm.
//
// Pairs are summed by the possible changes of their pixel as a whole: grooves shift and are mapped linearly about its
// middle, its footprint is mapped, its half vector moves. This ignores footprints that cease to be parallelograms, and
// square ends that do not stay square under a linear map.
#pragma once

#include <Eigen/Core>
#include <array>

#include "burin/render/fast/tile_kernel.h"
#include "burin/render/groove_sums.h"
#include "burin/render/pixel_shading.h"

namespace burin {

/// Sums of one pixel.
struct PixelSlopes {
  float light = 0, area_mm2 = 0;  ///< light: in units of `unit` below times mm^2
  std::array<float, kPixelSlopes> by{};
};

/// `p`: a lit and visible pixel; `corners_mm` and `area_mm2`: of its footprint; `unit`: value of a light of 1; `alpha`:
/// the shared roughness, used for the derivatives of shadowing by the cosines.
GrooveSums groove_sums(const PixelSlopes& slopes, double unit, const PixelShading& p,
                       const std::array<Eigen::Vector2d, 4>& corners_mm, double area_mm2, double alpha);

}  // namespace burin
