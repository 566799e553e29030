// burin/render/exact/exact_view.h - one view rendered pair by pair in double: slow and simple, the reference of the
// fast path. Frame: board, mm.
// docs/model.md 5. Use it through burin/render/view_renderer.h (RenderOptions::use_double).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "burin/base/image.h"
#include "burin/render/exact/scratch_pair.h"
#include "burin/render/fast/pairs.h"
#include "burin/render/pixel_shading.h"
#include "burin/render/view_scene.h"
#include "burin/scene/scratch_gradients.h"
#include "burin/scene/scratches.h"

namespace burin {

/// The part of a view without scratches, for every pixel with a footprint.
struct ViewPixels {
  int channels = 1;
  std::vector<PixelShading> shading;  ///< width * height
  std::vector<double> area_mm2;       ///< of the footprint; 0 without one

  std::size_t size() const { return shading.size(); }
};

/// Throws Error for scene values out of range, a grid with arrays that do not fit its window, or channels other than 1
/// and 3.
void check_view(const ViewScene& scene, int channels);

/// Area of a pixel with these corners; 0 without a footprint.
double footprint_area_mm2(const FootprintGrid& grid, std::size_t pixel,
                          const std::array<Eigen::Vector2d, 4>& corners_mm);

/// The shading of one pixel with a footprint; not lit if it is hidden from the lamp.
PixelShading shade_pixel(const ViewScene& scene, std::size_t pixel);

/// Checks the scene and shades every pixel.
ViewPixels view_pixels(const ViewScene& scene, int channels);

/// F_c(cos_ho) intensity_c of each channel, or its mean in [0] for a mono sensor; and its derivative by cos_ho.
std::array<double, 3> channel_factors(const ViewScene& scene, double cos_ho, int channels);
std::array<double, 3> channel_factor_slopes(const ViewScene& scene, double cos_ho, int channels);
/// ambient_c F0_c of each channel, or its mean in [0].
std::array<double, 3> ambient_radiance(const ViewScene& scene, int channels);

class ExactView {
 public:
  /// `scene` and `pixels` must outlive this object.
  /// `widest_band_um` as in profile_bands(): within a band light is constant.
  ExactView(const ViewScene& scene, const ViewPixels& pixels, double widest_band_um = 15)
      : scene_(scene), pixels_(pixels), widest_band_um_(widest_band_um) {}

  /// Radiance from the given pairs. `keep_jacobian` permits backward().
  void forward(const Scratches& scratches, PixelPairs pairs, bool keep_jacobian, Image& radiance);
  void backward(const Image& dE_dradiance, ScratchGradients& gradients) const;
  void add_contributions(std::vector<double>& contribution) const;
  std::size_t pair_count() const { return pairs_.scratch.size(); }

  /// The last radiance before rounding to an Image.
  const std::vector<double>& radiance() const { return radiance_; }

 private:
  /// Derivatives of Dhat G, and of the area, by the scratch's x0 y0 x1 y1, width, depth, alpha.
  struct PairJacobian {
    std::array<double, 7> light{};
    std::array<double, 6> area{};
  };
  /// visit(scratch, pair, pixel), a scratch's pairs in pixel order, in parallel.
  template <typename Visit>
  void gather(const Visit& visit) const;

  const ViewScene& scene_;
  const ViewPixels& pixels_;
  double widest_band_um_;
  std::size_t scratch_count_ = 0;
  PixelPairs pairs_;
  std::vector<double> pair_light_mm2_;  ///< Dhat G of each pair
  std::vector<PairJacobian> jacobian_;
  std::vector<double> radiance_;
  std::vector<double> covered_;  ///< of each pixel, not clamped
};

}  // namespace burin
