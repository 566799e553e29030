// What views share, and what of the Jacobian is kept, never changes a bit of the results.
#include "burin/render/fast/render_workspace.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "burin/render/fast/byte_store.h"
#include "tests/render/small_world.h"

namespace burin {
namespace {

struct Rendered {
  Image radiance;
  ScratchGradients gradients;
  std::vector<double> contribution;
  std::size_t pairs = 0;
};

Rendered render(ViewRenderer& renderer, const Scratches& scratches, const Image& weights) {
  Rendered r;
  r.gradients.resize(scratches.size());
  r.contribution.assign(scratches.size(), 0);
  renderer.forward_with_jacobian(in_metal(scratches), r.radiance);
  renderer.backward(weights, r.gradients);
  renderer.add_contributions(r.contribution);
  r.pairs = renderer.pair_count();
  return r;
}

void expect_same_bits(const Rendered& a, const Rendered& b, const std::string& what) {
  EXPECT_EQ(a.radiance.data, b.radiance.data) << what;
  EXPECT_EQ(a.contribution, b.contribution) << what;
  EXPECT_EQ(a.pairs, b.pairs) << what;
  for (const auto member :
       {&ScratchGradients::x0_mm, &ScratchGradients::y0_mm, &ScratchGradients::x1_mm, &ScratchGradients::y1_mm,
        &ScratchGradients::width_um, &ScratchGradients::depth_um, &ScratchGradients::alpha})
    EXPECT_EQ(a.gradients.*member, b.gradients.*member) << what;
  EXPECT_EQ(a.gradients.shared_base_alpha, b.gradients.shared_base_alpha) << what;
  EXPECT_EQ(a.gradients.shared_alpha, b.gradients.shared_alpha) << what;
}

/// A picture of several tiles.
World wide_world() {
  World w = small_world(300);
  w.scene.grid = share(board_grid({0, 0}, {20, 20}, 150, 110, {w.board.size_mm, {0, 0, 0}}));
  return w;
}

TEST(RenderWorkspace, WhatIsNotKeptOfTheJacobianIsComputedAgain) {
  const World w = wide_world();
  const Image weights = random_weights(w, 1, 3);
  for (const bool material : {true, false}) {
    RenderOptions options;
    options.material_gradients = material;
    ViewRenderer kept(w.scene, options);
    const Rendered expected = render(kept, w.scratches, weights);
    ASSERT_GT(expected.pairs, 5000U);
    // Nothing, some tiles, the places alone.
    for (const std::size_t bytes : {0, 40'000, 60'000}) {
      ViewRenderer renderer(w.scene, options, make_render_workspace(bytes));
      for (int again = 0; again < 2; ++again)
        expect_same_bits(render(renderer, w.scratches, weights), expected, std::to_string(bytes) + " bytes");
    }
  }
}

TEST(RenderWorkspace, ViewsThatShareItGiveWhatEachGivesAlone) {
  World w = wide_world();
  const Image weights = random_weights(w, 1, 3);
  ViewScene other = w.scene;
  other.camera_center_mm += Eigen::Vector3d(5, -9, 3);
  other.light.position_mm += Eigen::Vector3d(-4, 3, 1);
  ViewScene coarser = w.scene;  // another grid
  coarser.grid = share(board_grid({0, 0}, {20, 20}, 90, 70, {w.board.size_mm, {0, 0, 0}}));
  const Image fewer_weights(90, 70, 1, 0.5F);
  const std::shared_ptr<RenderWorkspace> workspace = make_render_workspace();
  ViewRenderer first(w.scene, {}, workspace), second(other, {}, workspace), third(coarser, {}, workspace);
  Scratches scratches = w.scratches;
  for (int iteration = 0; iteration < 4; ++iteration) {
    // Every kind of change that a design makes to its scratches, one at a time.
    if (iteration == 1) scratches.y1_mm.back() += 0.3;
    if (iteration == 2) scratches.depth_um[7] *= 1.2;
    if (iteration == 3)
      for (auto* v : {&scratches.x0_mm, &scratches.y0_mm, &scratches.x1_mm, &scratches.y1_mm, &scratches.width_um,
                      &scratches.depth_um, &scratches.alpha})
        v->pop_back();
    for (const auto& [shared, scene] : {std::pair{&first, &w.scene}, {&second, &other}, {&third, &coarser}}) {
      ViewRenderer alone(*scene, {});
      const Image& by = shared == &third ? fewer_weights : weights;
      expect_same_bits(render(*shared, scratches, by), render(alone, scratches, by),
                       "iteration " + std::to_string(iteration));
    }
  }
}

TEST(RenderWorkspace, TilesOfGridsInTurnAreKeptWhileThereIsRoom) {
  const World w = wide_world();
  const auto coarser = share(board_grid({0, 0}, {20, 20}, 90, 70, {w.board.size_mm, {0, 0, 0}}));
  TileCache roomy(100'000'000), narrow(1);
  const auto first = roomy.of(w.scene.grid);
  EXPECT_NE(roomy.of(coarser), first);
  EXPECT_EQ(roomy.of(w.scene.grid), first);
  const auto alone = narrow.of(w.scene.grid);
  EXPECT_EQ(narrow.of(w.scene.grid), alone);
  narrow.of(coarser);
  EXPECT_NE(narrow.of(w.scene.grid), alone);
  EXPECT_GT(first->bytes(), 1000U);
  // Views that render in turn are what they are alone.
  const Image weights = random_weights(w, 1, 3);
  const auto cache = make_tile_cache();
  ViewRenderer expected(w.scene, {});
  for (int again = 0; again < 2; ++again) {
    ViewScene other = w.scene;
    other.grid = coarser;
    ViewRenderer(other, {}, make_render_workspace(kUsualJacobianBytes, cache));
    ViewRenderer shared(w.scene, {}, make_render_workspace(kUsualJacobianBytes, cache));
    expect_same_bits(render(shared, w.scratches, weights), render(expected, w.scratches, weights), "shared tiles");
  }
}

TEST(RenderWorkspace, AGridIsCutIntoTilesOnceForAllThatUseIt) {
  RenderWorkspace workspace(1'000'000);
  const auto grid = share(board_grid({0, 0}, {20, 20}, 50, 40, {{20, 20}, {0, 0, 0}}));
  const auto tiles = workspace.tiles_of(grid);
  EXPECT_EQ(workspace.tiles_of(grid), tiles);
  EXPECT_NE(workspace.tiles_of(share(board_grid({0, 0}, {20, 20}, 50, 40, {{20, 20}, {0, 0, 0}}))), tiles);
}

TEST(ByteStore, HandsOutRoomUpToItsLimitAndAllOfItAgain) {
  ByteStore store(10'000'000);
  for (int again = 0; again < 3; ++again) {
    std::size_t taken = 0;
    std::byte* last = nullptr;
    while (std::byte* const workspace = store.take(900'001)) {
      EXPECT_EQ(reinterpret_cast<std::uintptr_t>(workspace) % 64, 0U);
      EXPECT_NE(workspace, last);
      std::fill_n(last = workspace, 900'001, std::byte{1});
      taken += 900'001;
    }
    // What is left over at the ends of blocks is lost.
    EXPECT_GT(taken, 7'000'000U);
    EXPECT_LE(taken, 10'000'000U);
    store.clear();
  }
  EXPECT_EQ(store.take(10'000'001), nullptr);
  EXPECT_EQ(ByteStore(0).take(1), nullptr);
}

}  // namespace
}  // namespace burin
