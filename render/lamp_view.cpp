#include "burin/render/lamp_view.h"

#include <utility>
#include <vector>

#include "burin/render/exact/exact_view.h"
#include "burin/render/fast/fast_view.h"
#include "burin/render/fast/pairs.h"
#include "burin/render/scene_parts.h"

namespace burin {

struct LampView::Data {
  KernelMode with_jacobian = KernelMode::material;
  std::unique_ptr<FastView> fast;
  // One point of the lamp.
  struct Exact {
    ViewScene scene;
    PixelIndex index;
    ViewPixels pixels;
    ExactView view;

    Exact(ViewScene s, const RenderOptions& options)
        : scene(std::move(s)), index(*scene.grid), pixels(view_pixels(scene, options.channels)), view(scene, pixels) {}
  };
  std::vector<std::unique_ptr<Exact>> exact;
};

LampView::LampView(const ViewScene& scene, const RenderOptions& options, std::shared_ptr<RenderWorkspace> workspace)
    : data_(std::make_unique<Data>()) {
  check_view(scene, options.channels);
  data_->with_jacobian = options.material_gradients ? KernelMode::material : KernelMode::ends;
  if (!options.use_double) {  // the fast path copies its part of the scene in float
    data_->fast = std::make_unique<FastView>(scene, options.channels, options.material_gradients, options.simd,
                                             workspace != nullptr ? std::move(workspace) : make_render_workspace());
    if (data_->fast->is_smooth()) return;
    data_->fast.reset();
  }
  for (ScenePart& part : scene_parts(scene)) {
    part.scene.light.intensity *= part.share;
    if (!data_->exact.empty()) part.scene.ambient.setZero();  // ambient light counts once
    data_->exact.push_back(std::make_unique<Data::Exact>(std::move(part.scene), options));
  }
}

LampView::~LampView() = default;

void LampView::forward(const Scratches& scratches, bool keep_jacobian, Image& radiance) {
  if (data_->fast) {
    data_->fast->forward(scratches, keep_jacobian ? data_->with_jacobian : KernelMode::value, radiance);
    return;
  }
  Image one;
  for (const auto& exact : data_->exact) {
    const ViewScene& scene = exact->scene;
    const std::vector<Strip> strips = strips_of(scratches, scene.tool_width_um, scene.material);
    const bool is_first = exact == data_->exact.front();
    exact->view.forward(scratches, find_pairs(exact->index, scene.grid->width(), scene.grid->height(), strips),
                        keep_jacobian, is_first ? radiance : one);
    if (!is_first) add_share(one, 1, radiance);
  }
}

void LampView::backward(const Image& dE_dradiance, ScratchGradients& gradients) const {
  if (data_->fast) data_->fast->backward(dE_dradiance, gradients);
  for (const auto& exact : data_->exact) exact->view.backward(dE_dradiance, gradients);
}

void LampView::add_contributions(std::vector<double>& contribution) const {
  if (data_->fast) data_->fast->add_contributions(contribution);
  for (const auto& exact : data_->exact) exact->view.add_contributions(contribution);
}

std::size_t LampView::pair_count() const {
  return data_->fast ? data_->fast->pair_count() : data_->exact.front()->view.pair_count();
}

}  // namespace burin
