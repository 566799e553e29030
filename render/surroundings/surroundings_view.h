// burin/render/surroundings/surroundings_view.h - one view under an environment map, by tables, as fast as under a
// lamp. It uses the tiles and SIMD vectors of burin/render/fast, one view per channel. docs/model.md 10. LightsView
// owns it.
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

/// ViewRenderer's work under one environment map or area light. Under an area light, hidden pixels
/// (ViewScene::hidden_from_light) are dark. Excludes ambient light. RenderOptions::use_double throws Error
/// for cross-sections other than the paper's.
class SurroundingsView {
 public:
  SurroundingsView(const ViewScene& scene, const Light& light, const RenderOptions& options,
                   const std::shared_ptr<RenderWorkspace>& workspace);
  ~SurroundingsView();

  /// Adds the radiance to `radiance`, which has the view's size; with `instead`, replaces it. Deterministic for any
  /// number of threads.
  void add_radiance(const Scratches& scratches, bool keep_jacobian, bool instead, Image& radiance);
  /// `scratches`: those of the last add_radiance(). Renders again if other views have used the workspace since.
  void backward(const Scratches& scratches, const Image& dE_dradiance, ScratchGradients& gradients) const;
  void add_contributions(const Scratches& scratches, std::vector<double>& contribution) const;
  std::size_t pair_count() const;

 private:
  struct Data;
  std::unique_ptr<Data> data_;
};

}  // namespace burin
