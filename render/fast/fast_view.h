// burin/render/fast/fast_view.h - one view rendered in float packets: the fast twin of burin/render/exact/exact_view.h.
// docs/model.md 8.
//
// The picture is cut into tiles of kTile x kTile pixels (burin/render/fast/tile.h). Each iteration: scratches are
// sorted into the tiles that they touch (burin/render/fast/tile_runs.h); each tile then works through its runs by
// itself (burin/render/fast/tile_kernel.h), so that what it adds up stays in the cache, and every sum has one order,
// whatever the number of threads. A run's pairs lie one after the other, with their Jacobian, so backward() is a gather
// over pixel weights. Frame: board, mm.
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

/// What the plain face sends, a number a pixel of the picture, and by base_alpha (not read without material).
struct PlainFace {
  std::vector<float> light, by_base_alpha;
};

class FastView {
 public:
  /// Under a lamp. `scene` must have passed check_view(); it may go. `material`: whether forward() will be asked for
  /// it. `workspace` may be shared by views that are worked on one after the other. The paper's grooves under a point
  /// lamp are lobes (docs/model.md 4); others, and those under a lamp with an area, are curves (8.6).
  FastView(const ViewScene& scene, int channels, bool material, SimdWidth width,
           std::shared_ptr<RenderWorkspace> workspace);
  /// A mono view in which a groove's light is a curve across it (set_curves()). Ambient light is not added.
  FastView(const ViewScene& scene, const PlainFace& face, bool material, SimdWidth width,
           std::shared_ptr<RenderWorkspace> workspace);
  ~FastView();
  FastView(const FastView&) = delete;
  FastView& operator=(const FastView&) = delete;

  /// Whether what it makes of the scene is good: where half vectors do not change smoothly over the face, curves are
  /// not.
  bool is_smooth() const;
  /// Before the first forward() of a view with curves; for the scratches of that and the next.
  void set_curves(std::shared_ptr<const CurveTables> curves);
  void forward(const Scratches& scratches, KernelMode mode, Image& radiance);
  /// Needs a forward() with KernelMode::ends or material. Derivatives by material are left as they are after `ends`.
  void backward(const Image& dE_dradiance, ScratchGradients& gradients) const;
  void add_contributions(std::vector<double>& contribution) const;
  /// What the grooves of each of the picture's pixels add up to, with all slopes; asks for no
  /// `material`.
  void pixel_slopes(const Scratches& scratches, std::vector<PixelSlopes>& out);
  /// Whether light in pixel_slopes() has the lamp's strength in it, F intensity direct (the mean of the channels).
  bool has_lamp_curves() const;
  /// Of pixels and strips: a burr is a strip beside its groove (burin/render/fast/groove_strips.h).
  std::size_t pair_count() const;
  /// Whether backward() serves: no other view has worked in the workspace since the forward().
  bool has_jacobian() const;

 private:
  struct Data;
  std::unique_ptr<Data> data_;
};

}  // namespace burin
