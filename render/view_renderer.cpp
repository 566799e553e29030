#include "render/view_renderer.h"

#include <string>
#include <utility>

#include "render/board_mesh.h"
#include "render/error.h"
#include "render/exact_view.h"
#include "render/fast_view.h"
#include "render/pairs.h"

namespace burin {

void ScratchGradients::resize(std::size_t scratch_count) {
  for (std::vector<double>* v : {&x0_mm, &y0_mm, &x1_mm, &y1_mm, &width_um, &depth_um, &alpha})
    v->assign(scratch_count, 0);
  shared_width_um = shared_depth_um = shared_alpha = shared_base_alpha = 0;
}

struct ViewRenderer::State {
  ViewScene scene;
  RenderOptions options;
  PixelIndex index;
  ViewPixels pixels;  // of the exact twin
  std::unique_ptr<ExactView> exact;
  std::unique_ptr<FastView> fast;
  std::size_t scratch_count = 0;

  State(ViewScene s, const RenderOptions& o, std::shared_ptr<RenderRoom> room)
      : scene(std::move(s)), options(o), index(checked_grid()) {
    if (options.use_double) {
      pixels = view_pixels(scene, options.channels);
      exact = std::make_unique<ExactView>(scene, pixels);
    } else {
      fast = std::make_unique<FastView>(scene, index, options.channels, options.simd,
                                        room != nullptr ? std::move(room) : make_render_room());
    }
  }

  const FootprintGrid& checked_grid() const {
    check_view(scene, options.channels);
    return scene.grid;
  }

  void forward(const Scratches& scratches, bool keep_jacobian, Image& radiance) {
    check_scratches(scratches);
    scratch_count = scratches.size();
    if (fast) {
      const KernelMode with = options.material_gradients ? KernelMode::material : KernelMode::ends;
      fast->forward(scratches, keep_jacobian ? with : KernelMode::value, radiance);
      return;
    }
    const std::vector<Strip> strips = strips_of(scratches, scene.tool_width_um, scene.material.depth_um);
    exact->forward(scratches, find_pairs(index, scene.grid.width(), scene.grid.height(), strips), keep_jacobian,
                   radiance);
  }
};

ViewRenderer::ViewRenderer(ViewScene scene, RenderOptions options, std::shared_ptr<RenderRoom> room)
    : state_(std::make_unique<State>(std::move(scene), options, std::move(room))) {}
ViewRenderer::~ViewRenderer() = default;
ViewRenderer::ViewRenderer(ViewRenderer&&) noexcept = default;
ViewRenderer& ViewRenderer::operator=(ViewRenderer&&) noexcept = default;

const ViewScene& ViewRenderer::scene() const { return state_->scene; }

void ViewRenderer::forward(const Scratches& scratches, Image& radiance) { state_->forward(scratches, false, radiance); }

void ViewRenderer::forward_with_jacobian(const Scratches& scratches, Image& radiance) {
  state_->forward(scratches, true, radiance);
}

void ViewRenderer::backward(const Image& dE_dradiance, ScratchGradients& gradients) const {
  const FootprintGrid& grid = state_->scene.grid;
  if (dE_dradiance.width != grid.width() || dE_dradiance.height != grid.height() ||
      dE_dradiance.channels != state_->options.channels)
    fail("ViewRenderer::backward", "dE/dradiance has another size than the view",
         "give " + std::to_string(grid.width()) + " x " + std::to_string(grid.height()) + " x " +
             std::to_string(state_->options.channels));
  if (gradients.x0_mm.size() != state_->scratch_count)
    fail("ViewRenderer::backward", "the gradients are for " + std::to_string(gradients.x0_mm.size()) + " scratches",
         "resize() them to the " + std::to_string(state_->scratch_count) + " of the last forward_with_jacobian()");
  if (state_->fast)
    state_->fast->backward(dE_dradiance, gradients);
  else
    state_->exact->backward(dE_dradiance, gradients);
}

void ViewRenderer::add_contributions(std::vector<double>& contribution) const {
  if (contribution.size() != state_->scratch_count)
    fail("ViewRenderer::add_contributions", "there are " + std::to_string(contribution.size()) + " numbers",
         "give one for each of the " + std::to_string(state_->scratch_count) + " scratches of the last forward()");
  if (state_->fast)
    state_->fast->add_contributions(contribution);
  else
    state_->exact->add_contributions(contribution);
}

std::size_t ViewRenderer::pair_count() const {
  return state_->fast ? state_->fast->pair_count() : state_->exact->pair_count();
}

CameraView make_camera_view(const Bench& bench, const Board& board, const View& view, const PixelWindow& window) {
  return {bench.lens, view.T_camera_board, Surface{board.size_mm, bench.bow_mm}, window};
}

ViewScene make_scene(const Bench& bench, const Board& board, const CameraView& camera, const Light& light) {
  ViewScene scene;
  if (board.mesh.empty()) {
    scene.grid = camera_grid(camera.lens, camera.T_camera_board, camera.surface, camera.window);
  } else {
    const BoardMesh mesh(read_obj(board.mesh), board.size_mm, board.mesh.string());
    scene.grid = camera_grid(camera.lens, camera.T_camera_board, mesh, camera.window);
    scene.hidden_from_light = hidden_pixels(scene.grid, mesh, light.position_mm);
  }
  scene.camera_center_mm = camera.T_camera_board.inverse().translation();
  scene.light = light;
  scene.material = bench.material;
  scene.tool_width_um = board.tool_width_um;
  scene.ambient = bench.ambient;
  return scene;
}

Image render_brute_force(const ViewScene& scene, const Scratches& scratches, int channels) {
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
