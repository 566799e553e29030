// burin/render/lights_view.h - one view under the sun, under surroundings, or under several lights at once: the sum of
// what each sends. docs/model.md 10. Made and used by ViewRenderer.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "burin/render/surroundings/surroundings_view.h"
#include "burin/render/view_renderer.h"

namespace burin {

/// What ViewRenderer does, light by light in one workspace. The sun is a lamp far away under which grooves are a little
/// rougher (docs/model.md 10.4). Going back renders all lamps but the last once more. Hidden pixels
/// (ViewScene::hidden_from_light) are those of a lone lamp; others shine on them.
class LightsView {
 public:
  LightsView(const ViewScene& scene, const RenderOptions& options, std::shared_ptr<RenderWorkspace> workspace);

  void forward(const Scratches& scratches, bool keep_jacobian, Image& radiance);
  void backward(const Image& dE_dradiance, ScratchGradients& gradients) const;
  void add_contributions(std::vector<double>& contribution) const;
  std::size_t pair_count() const { return pair_count_; }

 private:
  /// A lamp, or the sun: alpha^2 grows by `wider` under it.
  struct Lamp {
    std::unique_ptr<ViewRenderer> renderer;
    double wider = 0;
  };
  Carved under(const Lamp& lamp) const;
  /// What `gradients` got more since `before`, from the wider roughness to the groove's own.
  void narrow(const Lamp& lamp, const ScratchGradients& before, ScratchGradients& gradients) const;

  std::vector<Lamp> lamps_;
  std::vector<std::unique_ptr<SurroundingsView>> surroundings_;
  Scratches last_;
  Material material_;
  int width_ = 0, height_ = 0, channels_ = 1;
  std::size_t pair_count_ = 0;
};

}  // namespace burin
