// burin/render/lamp_view.h - one view under one lamp, rendered in float SIMD vectors or pair by pair in double.
// docs/model.md 5, 8. ViewRenderer owns one; LightsView owns one per lamp.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "burin/base/image.h"
#include "burin/render/view_scene.h"
#include "burin/scene/scratch_gradients.h"
#include "burin/scene/scratches.h"

namespace burin {

/// ViewRenderer's work under a single lamp. The lamp may have an area only if takes_area().
class LampView {
 public:
  /// True if the renderer integrates an area light itself. For the paper's grooves in float, points replace the area.
  static bool takes_area(const ViewScene& scene, const RenderOptions& options) {
    return !options.use_double && !scene.material.profile.is_paper();
  }
  /// Without a `workspace` the view owns one. Throws Error as check_view() does.
  LampView(const ViewScene& scene, const RenderOptions& options, std::shared_ptr<RenderWorkspace> workspace);
  ~LampView();
  LampView(const LampView&) = delete;
  LampView& operator=(const LampView&) = delete;

  /// `scratches` must have passed check_scratches(). `keep_jacobian` permits backward().
  void forward(const Scratches& scratches, bool keep_jacobian, Image& radiance);
  void backward(const Image& dE_dradiance, ScratchGradients& gradients) const;
  void add_contributions(std::vector<double>& contribution) const;
  std::size_t pair_count() const;

 private:
  struct Data;
  std::unique_ptr<Data> data_;
};

}  // namespace burin
