// burin/render/lamp_view.h - one view under one lamp, whichever way renders it: in float packets, or pair by pair
// in double. docs/model.md 5, 8. Made and used by ViewRenderer and, for each of its lamps, by LightsView.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "burin/base/image.h"
#include "burin/render/view_scene.h"
#include "burin/scene/scratch_gradients.h"
#include "burin/scene/scratches.h"

namespace burin {

/// What ViewRenderer does, under a light that is a lone lamp; with an area only where takes_area().
class LampView {
 public:
  /// Whether a lamp with an area is taken as it is: where the paper's grooves are in float it is points.
  static bool takes_area(const ViewScene& scene, const RenderOptions& options) {
    return !options.use_double && !scene.material.profile.is_paper();
  }
  /// Without a `workspace` it has one of its own. Throws Error as check_view() does.
  LampView(const ViewScene& scene, const RenderOptions& options, std::shared_ptr<RenderWorkspace> workspace);
  ~LampView();
  LampView(const LampView&) = delete;
  LampView& operator=(const LampView&) = delete;

  /// `scratches` must have passed check_scratches(). With `keep_jacobian` for backward().
  void forward(const Scratches& scratches, bool keep_jacobian, Image& radiance);
  void backward(const Image& dE_dradiance, ScratchGradients& gradients) const;
  void add_contributions(std::vector<double>& contribution) const;
  std::size_t pair_count() const;

 private:
  struct Data;
  std::unique_ptr<Data> data_;
};

}  // namespace burin
