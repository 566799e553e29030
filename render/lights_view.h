// burin/render/lights_view.h - one view under the sun, under surroundings, under a lamp with an area, or under several
// lights at once: the sum of what each sends. docs/model.md 5.5, 10. Made and used by ViewRenderer.
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

/// What ViewRenderer does, light by light in one workspace. The sun is a lamp far away under which grooves are a little
/// rougher (docs/model.md 10.4); a lamp with an area is a lamp for each point that stands for it (scene_parts.h), or
/// tabulated as surroundings are, or taken as it is where grooves are not the paper's. Going back renders all but the
/// last once more. Hidden pixels (ViewScene::hidden_from_light) are those of a lone lamp or, where there are so many,
/// of each light in turn (`light`, then its `also`). Otherwise several lights shine on all of them, and so do the sky
/// and other surroundings always.
class LightsView {
 public:
  LightsView(const ViewScene& scene, const RenderOptions& options, std::shared_ptr<RenderWorkspace> workspace);

  void forward(const Scratches& scratches, bool keep_jacobian, Image& radiance);
  void backward(const Image& dE_dradiance, ScratchGradients& gradients) const;
  void add_contributions(std::vector<double>& contribution) const;
  std::size_t pair_count() const { return pair_count_; }

 private:
  /// A point lamp, or the sun: alpha^2 grows by `wider` under it. `view` is kept, or made anew each time of `scene`.
  struct Lamp {
    ViewScene scene;
    double wider = 0;
    std::unique_ptr<LampView> view;
  };
  LampView& view_of(const Lamp& lamp, std::unique_ptr<LampView>& made) const;
  /// The view of lamp k, in which the last forward()'s Jacobian lies.
  LampView& with_jacobian(std::size_t k, std::unique_ptr<LampView>& made) const;
  Scratches under(const Lamp& lamp) const;
  /// What `gradients` got more since `before`, from the wider roughness to the groove's own.
  void narrow(const Lamp& lamp, const ScratchGradients& before, ScratchGradients& gradients) const;

  std::vector<Lamp> lamps_;
  std::vector<std::unique_ptr<SurroundingsView>> surroundings_;
  RenderOptions options_;
  std::shared_ptr<RenderWorkspace> workspace_;
  Scratches last_;
  Image one_;                               // of what is added to others; kept for the next time
  mutable bool last_has_jacobian_ = false;  // whether the last lamp's, of forward(), is in the workspace still
  Material material_;
  int width_ = 0, height_ = 0;
  std::size_t pair_count_ = 0;
};

}  // namespace burin
