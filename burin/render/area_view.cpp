#include "burin/render/area_view.h"

#include <utility>

namespace burin {
namespace {

void add_scaled(const Image& image, double by, Image& sum) {
  if (sum.data.empty()) sum = Image(image.width, image.height, image.channels);
  for (std::size_t i = 0; i < image.data.size(); ++i) sum.data[i] += static_cast<float>(by) * image.data[i];
}

}  // namespace

std::vector<ScenePart> scene_parts(const ViewScene& scene) {
  std::vector<ScenePart> out;
  for (const LampPoint& point : lamp_points(scene.light)) {
    out.push_back({scene, point.share});
    out.back().scene.light.position_mm += point.offset_mm;
    out.back().scene.light.size = {};
  }
  return out;
}

AreaView::AreaView(const ViewScene& scene, RenderOptions options, std::shared_ptr<RenderWorkspace> workspace)
    : parts_(scene_parts(scene)),
      options_(options),
      workspace_(workspace != nullptr ? std::move(workspace) : make_render_workspace()) {}

ViewRenderer AreaView::renderer_of(const ScenePart& part) const {
  return ViewRenderer(part.scene, options_, workspace_);
}

void AreaView::forward(const Scratches& scratches, Image& radiance) {
  last_.scratches = scratches;
  Image sum;
  for (const ScenePart& part : parts_) {
    ViewRenderer renderer = renderer_of(part);
    Image one;
    renderer.forward(last_, one);
    pair_count_ = renderer.pair_count();
    add_scaled(one, part.share, sum);
  }
  radiance = std::move(sum);
}

void AreaView::backward(const Image& dE_dradiance, ScratchGradients& gradients) const {
  for (const ScenePart& part : parts_) {
    ViewRenderer renderer = renderer_of(part);
    Image one, back;
    renderer.forward_with_jacobian(last_, one);
    add_scaled(dE_dradiance, part.share, back);
    renderer.backward(back, gradients);
  }
}

void AreaView::add_contributions(std::vector<double>& contribution) const {
  for (const ScenePart& part : parts_) {
    ViewRenderer renderer = renderer_of(part);
    Image one;
    renderer.forward_with_jacobian(last_, one);
    std::vector<double> own(contribution.size(), 0);
    renderer.add_contributions(own);
    for (std::size_t i = 0; i < own.size(); ++i) contribution[i] += part.share * own[i];
  }
}

}  // namespace burin
