// burin/render/fast/fast_view.h - one view in float SIMD vectors; burin/render/exact/exact_view.h is its
// double-precision reference. docs/model.md 8.
//
// The picture consists of tiles of kTile x kTile pixels (burin/render/fast/tile.h). Each iteration sorts scratches into
// the tiles that they touch (burin/render/fast/tile_runs.h). Each tile then processes its runs alone
// (burin/render/fast/tile_kernel.h), so its sums stay in the cache and have one order for any number of threads. A
// run's pairs are contiguous, with their Jacobian, so backward() is a gather over pixel weights. Frame: board, mm.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "burin/base/image.h"
#include "burin/base/simd_width.h"
#include "burin/render/fast/curve_tables.h"
#include "burin/render/fast/pixel_slopes.h"
#include "burin/render/fast/tile_kernel.h"
#include "burin/render/view_scene.h"
#include "burin/scene/scratch_gradients.h"
#include "burin/scene/scratches.h"

namespace burin {

/// Light of the plain face, one number per pixel, and its derivative by base_alpha (unused without material).
struct PlainFace {
  std::vector<float> light, by_base_alpha;
};

class FastView {
 public:
  /// Under a lamp. `scene` must have passed check_view(); the view keeps no reference to it. `material`: forward() may
  /// use KernelMode::material. Views that work one after the other may share `workspace`. The paper's grooves under a
  /// point lamp are lobes (docs/model.md 4). Other grooves, and all under an area light, are curves (8.6).
  FastView(const ViewScene& scene, int channels, bool material, SimdWidth width,
           std::shared_ptr<RenderWorkspace> workspace);
  /// A mono view with a groove's light as a curve across it (set_curves()). Excludes ambient light.
  FastView(const ViewScene& scene, const PlainFace& face, bool material, SimdWidth width,
           std::shared_ptr<RenderWorkspace> workspace);
  ~FastView();
  FastView(const FastView&) = delete;
  FastView& operator=(const FastView&) = delete;

  /// True if curves approximate the scene well. They fail if half vectors do not change smoothly over the face.
  bool is_smooth() const;
  /// Required before the first forward() of a view with curves. Applies to the scratches of all later calls.
  void set_curves(std::shared_ptr<const CurveTables> curves);
  void forward(const Scratches& scratches, KernelMode mode, Image& radiance);
  /// Requires a forward() with KernelMode::ends or material. After `ends` it leaves derivatives by material unchanged.
  void backward(const Image& dE_dradiance, ScratchGradients& gradients) const;
  void add_contributions(std::vector<double>& contribution) const;
  /// Sums over the grooves of each of the picture's pixels, with all derivatives. Does not require `material`.
  void pixel_slopes(const Scratches& scratches, std::vector<PixelSlopes>& out);
  /// True if light in pixel_slopes() includes the lamp's strength, F intensity direct (the mean of the channels).
  bool has_lamp_curves() const;
  /// Pairs of pixels and strips; a burr is a strip next to its groove (burin/render/fast/groove_strips.h).
  std::size_t pair_count() const;
  /// True if backward() is possible: no other view has used the workspace since the forward().
  bool has_jacobian() const;

 private:
  struct Data;
  std::unique_ptr<Data> data_;
};

}  // namespace burin
