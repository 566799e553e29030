// burin/render/surroundings/surroundings_view.h - one view under surroundings, by tables. docs/model.md 10. Made and
// used by LightsView.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "burin/render/view_renderer.h"

namespace burin {

/// What ViewRenderer does, under one light that is surroundings. Ambient light is not added. Throws Error for
/// cross-sections other than the paper's.
class SurroundingsView {
 public:
  SurroundingsView(const ViewScene& scene, const Light& light, const RenderOptions& options);
  ~SurroundingsView();

  /// Adds the radiance to `radiance`, which has the view's size. Deterministic, for any number of threads.
  void add_radiance(const Scratches& scratches, Image& radiance);
  /// For the scratches of the last add_radiance().
  void backward(const Image& dE_dradiance, ScratchGradients& gradients) const;
  void add_contributions(std::vector<double>& contribution) const;
  std::size_t pair_count() const;

 private:
  struct Data;
  std::unique_ptr<Data> data_;
};

}  // namespace burin
