// burin/render/exact/exact_sums.h - sums over a pixel's grooves, pair by pair in double: the reference of
// fast/pixel_slopes.h. docs/model.md 5. Frame: board, mm.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>

#include "burin/render/exact/scratch_pair.h"
#include "burin/render/fast/pairs.h"
#include "burin/render/groove_sums.h"
#include "burin/render/pixel_shading.h"
#include "burin/render/view_scene.h"
#include "burin/scene/scratches.h"

namespace burin {

/// A view's pairs, grouped by pixel, so that results do not depend on the number of threads.
struct ExactPairs {
  PixelPairs pairs;
  std::vector<ScratchFrame> frames;  ///< of the scratches
};
/// `widest_band_um` as in profile_bands().
ExactPairs exact_pairs(const ViewScene& scene, const Scratches& scratches, double widest_band_um = 15);

/// Sums of a lit and visible pixel; `pixel` is its index in the picture. Without `slopes`, light and area only.
GrooveSums exact_sums(const ViewScene& scene, const Scratches& scratches, const ExactPairs& of, std::size_t pixel,
                      const PixelShading& p, const std::array<Eigen::Vector2d, 4>& corners_mm, double pixel_area_mm2,
                      bool slopes);

}  // namespace burin
