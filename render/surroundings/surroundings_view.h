// burin/render/surroundings/surroundings_view.h - one view under surroundings, by tables, as fast as under a lamp: the
// tiles and packets of burin/render/fast, a view a channel. docs/model.md 10. Made and used by LightsView.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "burin/base/image.h"
#include "burin/render/view_scene.h"
#include "burin/scene/light.h"
#include "burin/scene/scratch_gradients.h"
#include "burin/scene/scratches.h"

namespace burin {

/// What ViewRenderer does, under one light that is surroundings, or a lamp with an area: then pixels that are hidden
/// from it (ViewScene::hidden_from_light) are dark. Ambient light is not added. Throws Error for cross-sections other
/// than the paper's.
class SurroundingsView {
 public:
  SurroundingsView(const ViewScene& scene, const Light& light, const RenderOptions& options,
                   const std::shared_ptr<RenderWorkspace>& workspace);
  ~SurroundingsView();

  /// Adds the radiance to `radiance`, which has the view's size; with `instead`, puts it in the place of what is there.
  /// Deterministic, for any number of threads.
  void add_radiance(const Scratches& scratches, bool keep_jacobian, bool instead, Image& radiance);
  /// `scratches`: those of the last add_radiance(). What other views have taken of the workspace is rendered once more.
  void backward(const Scratches& scratches, const Image& dE_dradiance, ScratchGradients& gradients) const;
  void add_contributions(const Scratches& scratches, std::vector<double>& contribution) const;
  std::size_t pair_count() const;

 private:
  struct Data;
  std::unique_ptr<Data> data_;
};

}  // namespace burin
