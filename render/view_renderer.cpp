#include "burin/render/view_renderer.h"

#include <string>
#include <utility>

#include "burin/base/error.h"
#include "burin/render/exact/exact_view.h"
#include "burin/render/fast/pairs.h"
#include "burin/render/lamp_view.h"
#include "burin/render/lanes_view.h"
#include "burin/render/lights_view.h"
#include "burin/scene/board_face.h"

namespace burin {

struct ViewRenderer::State {
  ViewScene scene;
  RenderOptions options;
  std::shared_ptr<RenderWorkspace> workspace;
  std::size_t scratch_count = 0;
  // Created on first use.
  std::unique_ptr<LampView> lamp;      // for a single lamp without a sum
  std::unique_ptr<LightsView> lights;  // for all other lights
  std::unique_ptr<LanesView> lanes;    // for grooves with their visible lanes
  Scratches grooves;                   // of the last forward() in lanes
  std::shared_ptr<const VisibleLanes> left;

  State(ViewScene of, const RenderOptions& o, std::shared_ptr<RenderWorkspace> r)
      : scene(std::move(of)), options(o), workspace(std::move(r)) {
    check_view(scene, options.channels);
  }
  LanedGrooves last_grooves() const { return {grooves, *left}; }

  void forward(const Carved& carved, bool keep_jacobian, Image& radiance) {
    const Scratches& scratches = carved.scratches;
    check_scratches(scratches);
    scratch_count = scratches.size();
    left = carved.lanes;
    if (left != nullptr) {
      if (!takes_lanes(scene))
        fail("grooves that cut one another", "are laid in lanes, which serve one lamp over a sheet",
             "cut them into pieces");
      if (!lanes) lanes = std::make_unique<LanesView>(scene, options.channels);
      grooves = scratches;
      lanes->forward(last_grooves(), keep_jacobian, radiance);
      return;
    }
    const bool is_lone = scene.light.is_lamp() && (scene.light.size.is_point() || LampView::takes_area(scene, options));
    if (is_lone) {
      if (!lamp) lamp = std::make_unique<LampView>(scene, options, workspace);
      lamp->forward(scratches, keep_jacobian, radiance);
    } else {
      if (!lights) lights = std::make_unique<LightsView>(scene, options, workspace);
      lights->forward(scratches, keep_jacobian, radiance);
    }
  }
};

ViewRenderer::ViewRenderer(ViewScene scene, RenderOptions options, std::shared_ptr<RenderWorkspace> workspace)
    : state_(std::make_unique<State>(std::move(scene), options, std::move(workspace))) {}
ViewRenderer::~ViewRenderer() = default;
ViewRenderer::ViewRenderer(ViewRenderer&&) noexcept = default;
ViewRenderer& ViewRenderer::operator=(ViewRenderer&&) noexcept = default;

int ViewRenderer::width() const { return state_->scene.grid->width(); }
int ViewRenderer::height() const { return state_->scene.grid->height(); }

void ViewRenderer::forward(const Carved& carved, Image& radiance) { state_->forward(carved, false, radiance); }

void ViewRenderer::forward_with_jacobian(const Carved& carved, Image& radiance) {
  state_->forward(carved, true, radiance);
}

ScratchGradients ViewRenderer::backward(const Image& dE_dradiance) const {
  ScratchGradients gradients;
  backward(dE_dradiance, gradients);
  return gradients;
}

void ViewRenderer::backward(const Image& dE_dradiance, ScratchGradients& gradients) const {
  if (dE_dradiance.width != width() || dE_dradiance.height != height() ||
      dE_dradiance.channels != state_->options.channels)
    fail("ViewRenderer::backward", "dE/dradiance has another size than the view",
         "give " + std::to_string(width()) + " x " + std::to_string(height()) + " x " +
             std::to_string(state_->options.channels));
  if (gradients.x0_mm.empty()) gradients.resize(state_->scratch_count);
  if (gradients.x0_mm.size() != state_->scratch_count)
    fail("ViewRenderer::backward", "the gradients are for " + std::to_string(gradients.x0_mm.size()) + " scratches",
         "give empty ones, or those of other views of the " + std::to_string(state_->scratch_count) +
             " scratches of the last forward_with_jacobian()");
  if (state_->left != nullptr)
    state_->lanes->backward(state_->last_grooves(), dE_dradiance, gradients);
  else if (state_->lights)
    state_->lights->backward(dE_dradiance, gradients);
  else
    state_->lamp->backward(dE_dradiance, gradients);
}

void ViewRenderer::add_contributions(std::vector<double>& contribution) const {
  if (contribution.size() != state_->scratch_count)
    fail("ViewRenderer::add_contributions", "there are " + std::to_string(contribution.size()) + " numbers",
         "give one for each of the " + std::to_string(state_->scratch_count) + " scratches of the last forward()");
  if (state_->left != nullptr)
    state_->lanes->add_contributions(state_->last_grooves(), contribution);
  else if (state_->lights)
    state_->lights->add_contributions(contribution);
  else
    state_->lamp->add_contributions(contribution);
}

std::size_t ViewRenderer::pair_count() const {
  if (state_->left != nullptr) return state_->lanes->chord_count();
  return state_->lights ? state_->lights->pair_count() : state_->lamp->pair_count();
}

CameraView make_camera_view(const Bench& bench, const Board& board, const View& view, const PixelWindow& window) {
  return {lens_of(bench, view), view.T_camera_board, surface_of(board, bench), window};
}

ViewScene make_scene(const Bench& bench, const Board& board, const CameraView& camera, const Light& light) {
  BoardFace face{camera.surface, nullptr};
  if (!board.mesh.empty()) face = face_of(board, bench);
  ViewScene scene =
      make_scene(bench, board, share(camera_grid(camera.lens, camera.T_camera_board, face, camera.window)),
                 camera.T_camera_board.inverse().translation(), light);
  scene.hidden_from_light = hidden_pixels(*scene.grid, face, light.position_mm);
  return scene;
}

ViewScene make_scene(const Bench& bench, const Board& board, std::shared_ptr<const FootprintGrid> grid,
                     const Eigen::Vector3d& camera_center_mm, const Light& light) {
  ViewScene scene;
  scene.grid = std::move(grid);
  scene.camera_center_mm = camera_center_mm;
  scene.light = light;
  scene.material = bench.material;
  scene.tool_width_um = board.tool_width_um;
  scene.ambient = bench.ambient;
  return scene;
}

ViewScene make_board_scene(const Bench& bench, const Board& board, int width, int height,
                           const Eigen::Vector3d& camera_center_mm, const Light& light) {
  const BoardFace face = face_of(board, bench);
  ViewScene scene =
      make_scene(bench, board, share(board_grid(board.carve_min_mm, board.carve_max_mm, width, height, face)),
                 camera_center_mm, light);
  scene.hidden_from_light = hidden_on_the_way(*scene.grid, face, camera_center_mm, light.position_mm);
  return scene;
}

Image render_brute_force(const ViewScene& scene, const Carved& carved, int channels) {
  const Scratches& scratches = carved.scratches;
  check_scratches(scratches);
  const ViewPixels pixels = view_pixels(scene, channels);
  PixelPairs all;
  all.begin.push_back(0);
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    if (pixels.area_mm2[i] > 0)
      for (std::size_t s = 0; s < scratches.size(); ++s)
        if (scratches.x0_mm[s] != scratches.x1_mm[s] || scratches.y0_mm[s] != scratches.y1_mm[s])
          all.scratch.push_back(static_cast<std::uint32_t>(s));
    all.begin.push_back(all.scratch.size());
  }
  ExactView exact(scene, pixels);
  Image radiance;
  exact.forward(scratches, std::move(all), false, radiance);
  return radiance;
}

}  // namespace burin
