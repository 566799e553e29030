#include "burin/render/lights_view.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "burin/render/scene_parts.h"
#include "burin/scene/far_light.h"

namespace burin {
namespace {

double wider_alpha(double alpha, double wider) { return std::min(1.0, std::sqrt(alpha * alpha + wider)); }

// Views of several lamps are kept up to this size. Larger ones are created for each use.
constexpr std::size_t kMostKept_bytes = 400'000'000;

// Hidden pixels of the k-th of `count` lights: the scene's flags, light after light. Flags of one picture do not apply
// to several lights.
std::vector<std::uint8_t> hidden_from(const ViewScene& scene, std::size_t k, std::size_t count) {
  const std::vector<std::uint8_t>& all = scene.hidden_from_light;
  if (count == 1) return all;
  const std::size_t pixels = scene.grid->center_mm.size();
  if (all.size() != count * pixels) return {};
  const auto first = all.begin() + static_cast<std::ptrdiff_t>(k * pixels);
  return {first, first + static_cast<std::ptrdiff_t>(pixels)};
}

// The scene under one lamp.
ViewScene scene_under(const ViewScene& scene, const Light& lamp, std::vector<std::uint8_t> hidden) {
  ViewScene out = scene;
  out.light = lamp;
  out.hidden_from_light = std::move(hidden);
  return out;
}

}  // namespace

LightsView::LightsView(const ViewScene& scene, const RenderOptions& options, std::shared_ptr<RenderWorkspace> workspace)
    : options_(options),
      workspace_(std::move(workspace)),
      material_(scene.material),
      width_(scene.grid->width()),
      height_(scene.grid->height()) {
  const bool shares_workspace = workspace_ != nullptr;
  if (workspace_ == nullptr) workspace_ = make_render_workspace();
  std::vector<Light> all{scene.light};
  all.insert(all.end(), scene.light.also.begin(), scene.light.also.end());
  all.front().also.clear();
  // Tables of an area light take a second to build and then cost less than its points. So they serve views that are
  // rendered repeatedly with moving ends: these share a workspace. Tables assume the board's directions of grooves, so
  // meshes with their own directions use points.
  const bool takes_area = LampView::takes_area(scene, options);
  const bool often =
      shares_workspace && !options.material_gradients && !options.use_double && scene.grid->x_axis.empty();
  const auto near = [&](const Light& l) {
    return l.far == nullptr ? l.size.is_point() || takes_area || !often : l.far->is_sun();
  };
  const auto add = [&](ViewScene own, double wider) {
    if (!lamps_.empty()) own.ambient.setZero();  // ambient light counts once
    lamps_.push_back({std::move(own), wider, nullptr});
  };
  for (std::size_t k = 0; k < all.size(); ++k) {
    const Light& light = all[k];
    if (!near(light)) continue;
    ViewScene own = scene_under(scene, light, hidden_from(scene, k, all.size()));
    double wider = 0;
    if (light.far) {
      own.light = sun_as_lamp(light);
      wider = widening(light.far->diameter_deg);
      own.material.alpha = wider_alpha(scene.material.alpha, wider);
      own.material.base_alpha = wider_alpha(scene.material.base_alpha, wider);
    }
    if (takes_area) {
      add(std::move(own), wider);
      continue;
    }
    for (ScenePart& part : scene_parts(own)) {
      part.scene.light.intensity *= part.share;
      add(std::move(part.scene), wider);
    }
  }
  if (lamps_.empty() && !scene.ambient.isZero(0)) {  // no lamp adds it
    Light dark;
    dark.position_mm = {0, 0, kFar_mm};
    dark.intensity.setZero();
    add(scene_under(scene, dark, {}), 0);
  }
  for (std::size_t k = 0; k < all.size(); ++k) {
    const Light& light = all[k];
    if (near(light)) continue;
    // Occluders of a lamp do not hide an environment map.
    std::vector<std::uint8_t> hidden;
    if (light.far == nullptr) hidden = hidden_from(scene, k, all.size());
    surroundings_.push_back(
        std::make_unique<SurroundingsView>(scene_under(scene, light, std::move(hidden)), light, options, workspace_));
  }
  // A view keeps about 25 bytes per pixel, plus 4 per further channel; in double ten times as much and its own
  // Jacobian.
  const std::size_t bytes = lamps_.size() * static_cast<std::size_t>(width_) * height_ * (21 + 4 * options.channels);
  if (lamps_.size() > 1 && (options.use_double || bytes > kMostKept_bytes)) return;
  for (Lamp& lamp : lamps_) {
    lamp.view = std::make_unique<LampView>(lamp.scene, options_, workspace_);
    lamp.scene = {};
  }
}

LampView& LightsView::view_of(const Lamp& lamp, std::unique_ptr<LampView>& made) const {
  if (lamp.view) return *lamp.view;
  made.reset();  // one at a time, because each is large
  made = std::make_unique<LampView>(lamp.scene, options_, workspace_);
  return *made;
}

LampView& LightsView::with_jacobian(std::size_t k, std::unique_ptr<LampView>& made) const {
  const Lamp& lamp = lamps_[k];
  LampView& view = view_of(lamp, made);
  const bool is_kept = lamp.view != nullptr && k + 1 == lamps_.size() && surroundings_.empty();
  if (is_kept && last_has_jacobian_) return view;
  Image again;
  view.forward(under(lamp), true, again);
  last_has_jacobian_ = is_kept;
  return view;
}

Scratches LightsView::under(const Lamp& lamp) const {
  Scratches out = last_;
  for (double& alpha : out.alpha) alpha = wider_alpha(alpha, lamp.wider);
  return out;
}

void LightsView::forward(const Scratches& scratches, bool keep_jacobian, Image& radiance) {
  last_ = scratches;
  last_has_jacobian_ = keep_jacobian;
  bool is_first = true;  // the first of several lights renders into the sum itself
  std::unique_ptr<LampView> made;
  for (std::size_t k = 0; k < lamps_.size(); ++k) {
    LampView& view = view_of(lamps_[k], made);
    Image& to = is_first ? radiance : one_;
    // One workspace holds one Jacobian: that of the last light.
    view.forward(under(lamps_[k]), keep_jacobian && k + 1 == lamps_.size() && surroundings_.empty(), to);
    if (!is_first)
      for (std::size_t i = 0; i < radiance.data.size(); ++i) radiance.data[i] += one_.data[i];
    is_first = false;
    pair_count_ = view.pair_count();
  }
  if (is_first && (radiance.width != width_ || radiance.height != height_ || radiance.channels != options_.channels))
    radiance = Image(width_, height_, options_.channels);
  for (const auto& around : surroundings_) {
    around->add_radiance(last_, keep_jacobian && around == surroundings_.back(), is_first, radiance);
    is_first = false;
    pair_count_ = around->pair_count();
  }
  if (is_first) std::fill(radiance.data.begin(), radiance.data.end(), 0.0F);
}

void LightsView::narrow(const Lamp& lamp, const ScratchGradients& before, ScratchGradients& gradients) const {
  const auto chain = [&](double was, double alpha, double& by) {
    by = was + (by - was) * alpha / wider_alpha(alpha, lamp.wider);
  };
  for (std::size_t i = 0; i < gradients.alpha.size(); ++i)
    chain(before.alpha[i], last_.alpha.empty() ? material_.alpha : last_.alpha[i], gradients.alpha[i]);
  chain(before.shared_alpha, material_.alpha, gradients.shared_alpha);
  chain(before.shared_base_alpha, material_.base_alpha, gradients.shared_base_alpha);
}

void LightsView::backward(const Image& dE_dradiance, ScratchGradients& gradients) const {
  for (std::size_t k = surroundings_.size(); k-- > 0;)  // the last one's Jacobian is still valid
    surroundings_[k]->backward(last_, dE_dradiance, gradients);
  std::unique_ptr<LampView> made;
  for (std::size_t k = lamps_.size(); k-- > 0;) {
    const LampView& view = with_jacobian(k, made);
    if (lamps_[k].wider == 0) {
      view.backward(dE_dradiance, gradients);
      continue;
    }
    const ScratchGradients before = gradients;
    view.backward(dE_dradiance, gradients);
    narrow(lamps_[k], before, gradients);
  }
}

void LightsView::add_contributions(std::vector<double>& contribution) const {
  std::unique_ptr<LampView> made;
  last_has_jacobian_ = false;  // the renderings below replace it
  for (const auto& one : surroundings_) one->add_contributions(last_, contribution);
  for (std::size_t k = 0; k < lamps_.size(); ++k) {
    LampView& view = view_of(lamps_[k], made);
    Image again;
    view.forward(under(lamps_[k]), false, again);
    view.add_contributions(contribution);
  }
}

}  // namespace burin
