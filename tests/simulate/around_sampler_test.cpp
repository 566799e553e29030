// The simulated camera under the sun and surroundings, which draws points and directions, against the renderer's
// tables: they differ by no more than two runs of the camera do.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "burin/render/view_renderer.h"
#include "burin/scene/far_light.h"
#include "burin/scene/look_at.h"
#include "burin/simulate/bench_truth.h"
#include "burin/simulate/point_sampler.h"

namespace burin {
namespace {

constexpr int kPhotoSide = 24;

BenchTruth truth_of_plate() {
  BenchTruth truth;
  truth.samples = truth.samples_plain = 1600;
  truth.lamp_samples = 16;
  truth.board.size_mm = {30, 30};
  truth.board.carve_min_mm = {1, 1};
  truth.board.carve_max_mm = {29, 29};
  truth.board.material.alpha = 0.06;
  truth.board.material.depth_um = 14;
  truth.board.material.base_alpha = 0.15;
  truth.believed = truth.board;
  truth.surface = {truth.board.size_mm, {0.1, 0, -0.1}};
  truth.lens = {
      "LENSMODEL_PINHOLE", {2500, 2500, 0.5 * (kPhotoSide - 1), 0.5 * (kPhotoSide - 1)}, kPhotoSide, kPhotoSide};
  return truth;
}

Sent fan_of_scratches() {
  Scratches s;
  for (int k = 0; k < 40; ++k) {
    const double a = std::numbers::pi * k / 40, x = 13.5 + 0.09 * k, y = 13.7 + 0.37 * (k % 8);
    s.x0_mm.push_back(x);
    s.y0_mm.push_back(y);
    s.x1_mm.push_back(x + 1.1 * std::cos(a));
    s.y1_mm.push_back(y + 1.1 * std::sin(a));
  }
  return Sent(s);
}

// A bright window, a dim half of the room, a floor.
Light windowed_room() {
  Image picture(72, 36, 3, 0.02F);
  for (int y = 0; y < 18; ++y)
    for (int x = 0; x < 36; ++x)
      for (int c = 0; c < 3; ++c) picture.at(x, y, c) = 0.2F + 0.1F * static_cast<float>(c);
  for (int y = 7; y < 11; ++y)
    for (int x = 50; x < 56; ++x)
      for (int c = 0; c < 3; ++c) picture.at(x, y, c) = 9;
  return surroundings_light(make_panorama(picture, {}, "room"), {1, 0.9, 0.8});
}

double mean_square(const Image& a, const Image& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.data.size(); ++i) sum += std::pow(a.data[i] - b.data[i], 2);
  return sum / static_cast<double>(a.data.size());
}

void expect_alike(const Light& light, const GrooveProfile& profile = {}) {
  BenchTruth truth = truth_of_plate();
  truth.board.material.profile = profile;
  TruthView view;
  view.name = "v";
  view.T_camera_board = look_at({40, 120, 380}, {15, 15, 0});
  const Carved carved = carved_by(truth, fan_of_scratches());
  truth.seed = 1;
  const Image one = PointSampler(truth, carved).radiance(view, light);
  truth.seed = 2;
  const Image two = PointSampler(truth, carved).radiance(view, light);
  ViewScene scene;
  scene.grid = share(camera_grid(truth.lens, view.T_camera_board, truth.surface, {0, 0, kPhotoSide, kPhotoSide}));
  scene.camera_center_mm = view.T_camera_board.inverse().translation();
  scene.light = light;
  scene.material = truth.board.material;
  Image tables, mean = one;
  ViewRenderer(scene, {3}).forward(carved, tables);
  for (std::size_t i = 0; i < mean.data.size(); ++i) mean.data[i] = 0.5F * (one.data[i] + two.data[i]);
  // Of noise alone a mean of two is off by a quarter of their mean squared difference. What is above is for the pixels'
  // directions, taken at their middles by the renderer.
  EXPECT_GT(mean_square(one, two), 0);
  EXPECT_LT(mean_square(mean, tables), 0.32 * mean_square(one, two)) << light.id;
}

TEST(AroundSampler, AgreesWithTheTablesInARoom) { expect_alike(windowed_room()); }

TEST(AroundSampler, AgreesForGroovesOfAnyCrossSection) {
  GrooveProfile profile;
  profile.kind = GrooveProfile::Kind::rounded_v;
  profile.flank_deg = 20;
  profile.burr_left_um = 3;
  profile.burr_right_um = 2;
  profile.burr_width_um = 25;
  profile.across = 1.43;
  expect_alike(windowed_room(), profile);
  profile.across = 0.7;
  expect_alike(windowed_room(), profile);
}

TEST(AroundSampler, AgreesUnderSunAndRoomAtOnce) {
  Light both = sun_light({0.2, -0.6, 0.9}, {0.5, 0.5, 0.4});
  both.also.push_back(windowed_room());
  expect_alike(both);
}

}  // namespace
}  // namespace burin
