// burin/render/area_view.h - one view under a lamp with an area: the mean over the points that stand for it
// (lamp_size.h), each rendered as a view of its own. docs/model.md 5.5. Made and used by ViewRenderer.
#pragma once

#include <memory>
#include <vector>

#include "burin/render/view_renderer.h"

namespace burin {

/// The scenes of a lamp's points, and their shares.
struct ScenePart {
  ViewScene scene;
  double share = 1;
};
std::vector<ScenePart> scene_parts(const ViewScene& scene);

/// What ViewRenderer does, of all parts one after the other in one workspace. Going back renders each part once more.
class AreaView {
 public:
  AreaView(const ViewScene& scene, RenderOptions options, std::shared_ptr<RenderWorkspace> workspace);

  void forward(const Scratches& scratches, Image& radiance);
  void backward(const Image& dE_dradiance, ScratchGradients& gradients) const;
  void add_contributions(std::vector<double>& contribution) const;
  std::size_t pair_count() const { return pair_count_; }

 private:
  ViewRenderer renderer_of(const ScenePart& part) const;

  std::vector<ScenePart> parts_;
  RenderOptions options_;
  std::shared_ptr<RenderWorkspace> workspace_;
  Carved last_;  // what forward() was called for
  std::size_t pair_count_ = 0;
};

}  // namespace burin
