// Proves: the colors of lamps come from the tags' white paper, black paper and the metal around it counting for
// nothing, for lamps of mixed and of pure colors, with noise; a session in gray leaves lamps as they are. What it makes
// of a photographed bench: calibrate_test.
#include "burin/calib/light/lamp_colors.h"

#include <gtest/gtest.h>

#include <numbers>
#include <random>

namespace burin {
namespace {

// A tag of 60 pixels at (40, 30) whose upper two fifths are white paper, under a lamp of that color; bright metal of
// another color around it.
MergedView photographed(const Eigen::Vector3d& color, double noise, unsigned seed) {
  MergedView view;
  view.value = Image(140, 120, 3);
  view.sigma = Image(140, 120, 3, 0.01F);
  view.valid.assign(140 * 120, 1);
  std::mt19937 random(seed);
  std::normal_distribution<float> grain(0, static_cast<float>(noise));
  for (int y = 0; y < 120; ++y)
    for (int x = 0; x < 140; ++x) {
      const bool tag = x >= 40 && x < 100 && y >= 30 && y < 90, white = tag && y < 54;
      for (int c = 0; c < 3; ++c) {
        const double metal = c == 0 ? 3 : 1;
        view.value.at(x, y, c) = static_cast<float>(color[c] * (white ? 0.8 : tag ? 0.04 : metal)) + grain(random);
      }
    }
  return view;
}

TagsInPhoto one_tag() {
  TagDetection tag;
  tag.id = 3;
  tag.corner_px = {Eigen::Vector2d(40, 30), Eigen::Vector2d(99, 30), Eigen::Vector2d(99, 89), Eigen::Vector2d(40, 89)};
  TagsInPhoto out;
  out.tags = {tag};
  return out;
}

TEST(LampColors, AreThoseOfThePaper) {
  const std::vector<Eigen::Vector3d> colors{{1, 0.25, 0.1}, {0, 2, 0}, {0.9, 1, 1.1}};
  Bench bench;
  std::vector<Bracket> brackets;
  std::vector<std::vector<Eigen::Vector3d>> paper;
  for (std::size_t l = 0; l < colors.size(); ++l) {
    Light light;
    light.id = "lamp" + std::to_string(l);
    light.intensity.setConstant(100);
    bench.lights.push_back(light);
    for (unsigned photo = 0; photo < 5; ++photo) {
      Bracket bracket;
      bracket.light = light.id;
      brackets.push_back(bracket);
      paper.push_back(paper_light(photographed(colors[l], 0.02, 7 * photo + static_cast<unsigned>(l)), one_tag()));
      ASSERT_EQ(paper.back().size(), 1U);
    }
  }
  Light unseen;
  unseen.id = "unseen";
  bench.lights.push_back(unseen);
  color_lamps(brackets, paper, Board(), bench);
  for (std::size_t l = 0; l < colors.size(); ++l) {
    EXPECT_NEAR(bench.lights[l].intensity.mean(), 100, 1e-9);
    // Noise of 0.02 over 720 pixels: below a hundredth of the paper's light, its pure lamps' dark channels included.
    const Eigen::Vector3d wanted = 100 / colors[l].mean() * colors[l];
    EXPECT_LT((bench.lights[l].intensity - wanted).norm(), 1) << l;
    EXPECT_GE(bench.lights[l].intensity.minCoeff(), 0) << l;
  }
  EXPECT_EQ(bench.lights[3].intensity, Eigen::Vector3d(1, 1, 1));
}

TEST(LampColors, AmbientLightIsTakenOff) {
  Board board;
  board.size_mm = {100, 100};
  Bench bench;
  bench.lights.resize(1);
  Light& lamp = bench.lights[0];
  lamp.position_mm = {50, 50, 1000};
  lamp.intensity.setConstant(1e6);  // 1 on paper
  bench.ambient.setConstant(0.5 / std::numbers::pi);
  Bracket bracket;
  bracket.light = lamp.id;
  const Eigen::Vector3d color(2, 0.7, 0.3);
  const std::vector<std::vector<Eigen::Vector3d>> paper{
      {(color + Eigen::Vector3d::Constant(0.5)) / 1.5}};  // of the lamp's 1 and the ambient 0.5
  color_lamps({&bracket, 1}, paper, board, bench);
  EXPECT_LT((lamp.intensity - 1e6 * color).norm(), 1e-3);
}

TEST(LampColors, PhotosInGrayTellNone) {
  MergedView gray = photographed({1, 0.5, 0.2}, 0, 1);
  gray.value = Image(140, 120, 1, 0.5F);
  EXPECT_TRUE(paper_light(gray, one_tag()).empty());
  Bench bench;
  bench.lights.resize(1);
  Bracket bracket;
  bracket.light = bench.lights[0].id;
  const std::vector<std::vector<Eigen::Vector3d>> none(1);
  color_lamps({&bracket, 1}, none, Board(), bench);
  EXPECT_EQ(bench.lights[0].intensity, Eigen::Vector3d(1, 1, 1));
}

}  // namespace
}  // namespace burin
