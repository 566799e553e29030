// burin/render/lights_view.h - one view under the sun, an environment map, an area light or several lights: the sum of
// their contributions. docs/model.md 5.5, 10. ViewRenderer owns and uses it.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "burin/base/image.h"
#include "burin/render/lamp_view.h"
#include "burin/render/surroundings/surroundings_view.h"
#include "burin/render/view_scene.h"
#include "burin/scene/scratch_gradients.h"
#include "burin/scene/scratches.h"

namespace burin {

/// ViewRenderer's work, light by light in one workspace.
/// - The sun is a distant lamp that makes grooves slightly rougher (docs/model.md 10.4).
/// - An area light becomes a set of point lamps (scene_parts.h), a table like an environment map, or, for grooves other
/// than the paper's, an area integral in the renderer.
/// - backward() renders every lamp except the last once more.
/// - Hidden pixels (ViewScene::hidden_from_light) belong to a single lamp, or to each light in order (`light`, then its
/// `also`) if each light has its flags. Otherwise several lights reach all pixels. The sky and other environment
/// maps always reach all pixels.
class LightsView {
 public:
  LightsView(const ViewScene& scene, const RenderOptions& options, std::shared_ptr<RenderWorkspace> workspace);

  void forward(const Scratches& scratches, bool keep_jacobian, Image& radiance);
  void backward(const Image& dE_dradiance, ScratchGradients& gradients) const;
  void add_contributions(std::vector<double>& contribution) const;
  std::size_t pair_count() const { return pair_count_; }

 private:
  /// A point lamp, or the sun, under which alpha^2 grows by `wider`. `view` is kept, or made from `scene` for each use.
  struct Lamp {
    ViewScene scene;
    double wider = 0;
    std::unique_ptr<LampView> view;
  };
  LampView& view_of(const Lamp& lamp, std::unique_ptr<LampView>& made) const;
  /// The view of lamp k with the Jacobian of the last forward().
  LampView& with_jacobian(std::size_t k, std::unique_ptr<LampView>& made) const;
  Scratches under(const Lamp& lamp) const;
  /// Scales the increase of `gradients` over `before` from the wider roughness to the groove's own.
  void narrow(const Lamp& lamp, const ScratchGradients& before, ScratchGradients& gradients) const;

  std::vector<Lamp> lamps_;
  std::vector<std::unique_ptr<SurroundingsView>> surroundings_;
  RenderOptions options_;
  std::shared_ptr<RenderWorkspace> workspace_;
  Scratches last_;
  Image one_;                               // light of one part, kept as a buffer
  mutable bool last_has_jacobian_ = false;  // the workspace still holds the last lamp's Jacobian
  Material material_;
  int width_ = 0, height_ = 0;
  std::size_t pair_count_ = 0;
};

}  // namespace burin
