#include "burin/render/lights_view.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "burin/render/far_light.h"

namespace burin {
namespace {

double wider_alpha(double alpha, double wider) { return std::min(1.0, std::sqrt(alpha * alpha + wider)); }

// The scene under one lamp. Ambient light counts once: with the first.
ViewScene scene_under(const ViewScene& scene, const Light& lamp, bool first, bool alone) {
  ViewScene out = scene;
  out.light = lamp;
  if (!first) out.ambient.setZero();
  if (!alone) out.hidden_from_light.clear();
  return out;
}

}  // namespace

LightsView::LightsView(const ViewScene& scene, const RenderOptions& options, std::shared_ptr<RenderWorkspace> workspace)
    : material_(scene.material),
      width_(scene.grid->width()),
      height_(scene.grid->height()),
      channels_(options.channels) {
  if (workspace == nullptr) workspace = make_render_workspace();
  std::vector<Light> all{scene.light};
  all.insert(all.end(), scene.light.also.begin(), scene.light.also.end());
  all.front().also.clear();
  const auto near = [](const Light& l) { return l.far == nullptr || l.far->is_sun(); };
  bool first = true;
  for (const Light& light : all) {
    if (!near(light)) continue;
    Lamp lamp;
    ViewScene own = scene_under(scene, light, first, all.size() == 1);
    if (light.far) {
      own.light = sun_as_lamp(light);
      lamp.wider = widening(light.far->diameter_deg);
      own.material.alpha = wider_alpha(scene.material.alpha, lamp.wider);
      own.material.base_alpha = wider_alpha(scene.material.base_alpha, lamp.wider);
    }
    lamp.renderer = std::make_unique<ViewRenderer>(std::move(own), options, workspace);
    lamps_.push_back(std::move(lamp));
    first = false;
  }
  if (first && !scene.ambient.isZero(0)) {  // no lamp adds it
    Light dark;
    dark.position_mm = {0, 0, kFar_mm};
    dark.intensity.setZero();
    Lamp lamp;
    lamp.renderer = std::make_unique<ViewRenderer>(scene_under(scene, dark, true, false), options, workspace);
    lamps_.push_back(std::move(lamp));
  }
  for (const Light& light : all)
    if (!near(light)) surroundings_.push_back(std::make_unique<SurroundingsView>(scene, light, options, workspace));
}

Carved LightsView::under(const Lamp& lamp) const {
  Carved out;
  out.scratches = last_;
  for (double& alpha : out.scratches.alpha) alpha = wider_alpha(alpha, lamp.wider);
  return out;
}

void LightsView::forward(const Scratches& scratches, bool keep_jacobian, Image& radiance) {
  last_ = scratches;
  Image sum(width_, height_, channels_);
  for (const Lamp& lamp : lamps_) {
    Image one;
    if (keep_jacobian)
      lamp.renderer->forward_with_jacobian(under(lamp), one);
    else
      lamp.renderer->forward(under(lamp), one);
    for (std::size_t i = 0; i < sum.data.size(); ++i) sum.data[i] += one.data[i];
    pair_count_ = lamp.renderer->pair_count();
  }
  for (const auto& one : surroundings_) {
    one->add_radiance(scratches, keep_jacobian, sum);
    pair_count_ = one->pair_count();
  }
  radiance = std::move(sum);
}

void LightsView::narrow(const Lamp& lamp, const ScratchGradients& before, ScratchGradients& gradients) const {
  if (lamp.wider == 0) return;
  const auto chain = [&](double was, double alpha, double& by) {
    by = was + (by - was) * alpha / wider_alpha(alpha, lamp.wider);
  };
  for (std::size_t i = 0; i < gradients.alpha.size(); ++i)
    chain(before.alpha[i], last_.alpha.empty() ? material_.alpha : last_.alpha[i], gradients.alpha[i]);
  chain(before.shared_alpha, material_.alpha, gradients.shared_alpha);
  chain(before.shared_base_alpha, material_.base_alpha, gradients.shared_base_alpha);
}

void LightsView::backward(const Image& dE_dradiance, ScratchGradients& gradients) const {
  for (std::size_t k = surroundings_.size(); k-- > 0;)  // the last one's Jacobian is there still
    surroundings_[k]->backward(dE_dradiance, gradients);
  for (std::size_t k = lamps_.size(); k-- > 0;) {
    const Lamp& lamp = lamps_[k];
    if (k + 1 < lamps_.size() || !surroundings_.empty()) {
      Image again;
      lamp.renderer->forward_with_jacobian(under(lamp), again);
    }
    const ScratchGradients before = gradients;
    lamp.renderer->backward(dE_dradiance, gradients);
    narrow(lamp, before, gradients);
  }
}

void LightsView::add_contributions(std::vector<double>& contribution) const {
  for (std::size_t k = lamps_.size(); k-- > 0;) {
    const Lamp& lamp = lamps_[k];
    if (k + 1 < lamps_.size() || !surroundings_.empty()) {
      Image again;
      lamp.renderer->forward_with_jacobian(under(lamp), again);
    }
    lamp.renderer->add_contributions(contribution);
  }
  for (const auto& one : surroundings_) one->add_contributions(contribution);
}

}  // namespace burin
