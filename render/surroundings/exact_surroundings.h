// burin/render/surroundings/exact_surroundings.h - one view under an environment map, pair by pair in double: the
// reference of burin/render/surroundings/surroundings_view.h. Both use the same tables of facets. docs/model.md 10.
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

/// Double-precision counterpart of SurroundingsView.
class ExactSurroundings {
 public:
  ExactSurroundings(const ViewScene& scene, const Light& light, const RenderOptions& options);
  ~ExactSurroundings();

  /// Adds the radiance to `radiance`, which has the view's size. Deterministic for any number of threads.
  void add_radiance(const Scratches& scratches, Image& radiance);
  /// Gradient for the scratches of the last add_radiance().
  void backward(const Image& dE_dradiance, ScratchGradients& gradients) const;
  void add_contributions(std::vector<double>& contribution) const;
  std::size_t pair_count() const;

 private:
  struct Data;
  std::unique_ptr<Data> data_;
};

}  // namespace burin
