#include "burin/render/lamp_view.h"

#include <utility>

#include "burin/render/exact/exact_view.h"
#include "burin/render/fast/fast_view.h"
#include "burin/render/fast/pairs.h"

namespace burin {

struct LampView::Data {
  KernelMode with_jacobian = KernelMode::material;
  std::unique_ptr<FastView> fast;
  struct Exact {
    ViewScene scene;
    PixelIndex index;
    ViewPixels pixels;
    ExactView view;

    Exact(ViewScene s, const RenderOptions& options)
        : scene(std::move(s)),
          index(*scene.grid),
          pixels(view_pixels(scene, options.channels)),
          view(scene, pixels,
               options.light_along_grooves && !options.use_double ? ExactView::BandLightBy::knots
                                                                  : ExactView::BandLightBy::pixel) {}
  };
  std::unique_ptr<Exact> exact;
};

LampView::LampView(ViewScene scene, const RenderOptions& options, std::shared_ptr<RenderWorkspace> workspace)
    : data_(std::make_unique<Data>()) {
  check_view(scene, options.channels);
  data_->with_jacobian = options.material_gradients ? KernelMode::material : KernelMode::ends;
  // The float path knows the paper's cross-section alone.
  if (options.use_double || !scene.material.profile.is_paper())
    data_->exact = std::make_unique<Data::Exact>(std::move(scene), options);
  else  // which keeps what it needs of the scene, in float
    data_->fast = std::make_unique<FastView>(scene, options.channels, options.material_gradients, options.simd,
                                             workspace != nullptr ? std::move(workspace) : make_render_workspace());
}

LampView::~LampView() = default;

void LampView::forward(const Scratches& scratches, bool keep_jacobian, Image& radiance) {
  if (data_->fast) {
    data_->fast->forward(scratches, keep_jacobian ? data_->with_jacobian : KernelMode::value, radiance);
    return;
  }
  const ViewScene& scene = data_->exact->scene;
  const std::vector<Strip> strips = strips_of(scratches, scene.tool_width_um, scene.material);
  data_->exact->view.forward(scratches,
                             find_pairs(data_->exact->index, scene.grid->width(), scene.grid->height(), strips),
                             keep_jacobian, radiance);
}

void LampView::backward(const Image& dE_dradiance, ScratchGradients& gradients) const {
  if (data_->fast)
    data_->fast->backward(dE_dradiance, gradients);
  else
    data_->exact->view.backward(dE_dradiance, gradients);
}

void LampView::add_contributions(std::vector<double>& contribution) const {
  if (data_->fast)
    data_->fast->add_contributions(contribution);
  else
    data_->exact->view.add_contributions(contribution);
}

std::size_t LampView::pair_count() const {
  return data_->fast ? data_->fast->pair_count() : data_->exact->view.pair_count();
}

}  // namespace burin
