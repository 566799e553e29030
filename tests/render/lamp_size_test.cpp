// What is proved: the few points that stand for a lamp with an area give the light of thousands of points of it, within
// the accuracy that lamp_size.h promises, for glints and for the renderer's views; the renderer's way back is the
// derivative of its way there; sizes that make no sense are errors with words. Not proved: that real lamps shine
// evenly.
#include "burin/scene/lamp_size.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "burin/base/error.h"
#include "burin/base/files/json_file.h"
#include "burin/render/scene_parts.h"
#include "burin/scene/files/lamp_size_json.h"
#include "tests/render/small_world.h"

namespace burin {
namespace {

Light lamp_with(const LampSize& size) {
  Light light;
  light.position_mm << 0, -300, 600;
  light.axis = -light.position_mm.normalized();
  light.size = size;
  return light;
}

// Evenly spread points of the area, by brute force.
std::vector<Eigen::Vector3d> many_points(const Light& light, int count) {
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto across = across_axis(light.axis, light.size.turn_deg);
  std::vector<Eigen::Vector3d> out;
  while (static_cast<int>(out.size()) < count) {
    const Eigen::Vector2d at(uniform(random), uniform(random));
    if (light.size.disk_mm > 0) {
      if (at.norm() <= 1) out.emplace_back(across * (light.size.disk_mm * at));
    } else {
      out.emplace_back(across * (0.5 * light.size.panel_mm).cwiseProduct(at));
    }
  }
  return out;
}

// What a groove of that roughness sends along a direction: the lobe's section through half vectors.
double glint(const Eigen::Vector3d& lamp, const Eigen::Vector3d& along, double alpha) {
  const Eigen::Vector3d h = (lamp.normalized() + Eigen::Vector3d(0.1, 0.4, 0.9).normalized()).normalized();
  const double lean = h.dot(along) / alpha;
  return std::pow(1 + lean * lean, -1.5) / lamp.squaredNorm();
}

void expect_rule_is_good(const LampSize& size, double alpha, double tolerance) {
  const Light light = lamp_with(size);
  const std::vector<Eigen::Vector3d> many = many_points(light, 10000);
  double worst = 0, peak = 0;
  for (int turn = 0; turn < 180; turn += 15) {
    const double angle = turn * std::numbers::pi / 180;
    for (double lean = -0.3; lean <= 0.3; lean += 0.03) {
      // Grooves that differ in direction, on a face that leans: half vectors from the glint's middle to its wings.
      const Eigen::Vector3d along = Eigen::Vector3d(std::cos(angle), std::sin(angle), lean).normalized();
      double exact = 0, by_rule = 0;
      for (const Eigen::Vector3d& offset : many)
        exact += glint(light.position_mm + offset, along, alpha) / static_cast<double>(many.size());
      for (const LampPoint& point : lamp_points(light))
        by_rule += point.share * glint(light.position_mm + point.offset_mm, along, alpha);
      worst = std::max(worst, std::abs(by_rule - exact));
      peak = std::max(peak, exact);
    }
  }
  EXPECT_LT(worst, tolerance * peak) << size.disk_mm << " " << size.panel_mm.transpose();
}

TEST(LampSize, FewPointsStandForManyInAGlint) {
  LampSize disk, large, panel, very_large, softbox;
  disk.disk_mm = 20;
  large.disk_mm = 50;
  panel.panel_mm << 120, 60;
  panel.turn_deg = 30;
  expect_rule_is_good(disk, 0.05, 0.01);
  expect_rule_is_good(large, 0.08, 0.01);
  expect_rule_is_good(panel, 0.08, 0.01);
  very_large.disk_mm = 120;
  softbox.panel_mm << 300, 200;
  softbox.turn_deg = 15;
  expect_rule_is_good(very_large, 0.08, 0.01);
  expect_rule_is_good(softbox, 0.08, 0.02);
}

TEST(LampSize, SharesAddUpAndThePointsLieAboutTheMiddleAcrossTheAxis) {
  for (const double disk_mm : {0., 10., 40., 60.})
    for (const Eigen::Vector2d& panel : {Eigen::Vector2d(0, 0), Eigen::Vector2d(100, 30)}) {
      LampSize size;
      size.disk_mm = disk_mm;
      if (disk_mm == 0) size.panel_mm = panel;
      const Light light = lamp_with(size);
      double shares = 0;
      Eigen::Vector3d mean = Eigen::Vector3d::Zero();
      double spread = 0;
      for (const LampPoint& point : lamp_points(light)) {
        shares += point.share;
        mean += point.share * point.offset_mm;
        spread += point.share * point.offset_mm.squaredNorm();
        EXPECT_NEAR(point.offset_mm.dot(light.axis), 0, 1e-9);
      }
      EXPECT_NEAR(shares, 1, 1e-12);
      EXPECT_LT(mean.norm(), 1e-9);
      // The points of a disk of radius r scatter by r^2 / 2 about its middle, a panel's by side^2 / 12 along each side.
      EXPECT_NEAR(spread, disk_mm > 0 ? disk_mm * disk_mm / 2 : size.panel_mm.squaredNorm() / 12, 1e-6);
    }
}

TEST(LampSize, AViewIsTheMeanOfThePointsViewsAndItsWayBackTheirDerivative) {
  World w = small_world();
  w.scene.light.size.disk_mm = 25;
  w.scene.light.axis = -w.scene.light.position_mm.normalized();
  const RenderOptions exact{1, true};
  ViewRenderer renderer(w.scene, exact);
  Image image;
  renderer.forward_with_jacobian(in_metal(w.scratches), image);
  Image mean(image.width, image.height, 1);
  const std::vector<ScenePart> parts = scene_parts(w.scene);
  ASSERT_EQ(parts.size(), lamp_points(w.scene.light).size());
  for (const ScenePart& part : parts) {
    Image one;
    ViewRenderer(part.scene, exact).forward(in_metal(w.scratches), one);
    for (std::size_t i = 0; i < one.data.size(); ++i) mean.data[i] += static_cast<float>(part.share) * one.data[i];
  }
  float brightest = 0;
  for (const float v : mean.data) brightest = std::max(brightest, v);
  ASSERT_GT(brightest, 0);
  for (std::size_t i = 0; i < mean.data.size(); ++i) EXPECT_NEAR(image.data[i], mean.data[i], 1e-5F * brightest);

  Image ones(image.width, image.height, 1, 1);
  const ScratchGradients g = renderer.backward(ones);
  const auto sum = [&] {
    Image moved;
    ViewRenderer(w.scene, exact).forward(in_metal(w.scratches), moved);
    double s = 0;
    for (const float v : moved.data) s += v;
    return s;
  };
  std::size_t checked = 0;
  for (std::size_t s = 0; s < w.scratches.size() && checked < 3; ++s) {
    if (std::abs(g.x0_mm[s]) < 1e-3 * brightest) continue;
    constexpr double kStep = 1e-3;
    const double kept = w.scratches.x0_mm[s];
    w.scratches.x0_mm[s] = kept + kStep;
    const double above = sum();
    w.scratches.x0_mm[s] = kept - kStep;
    const double below = sum();
    w.scratches.x0_mm[s] = kept;
    EXPECT_NEAR((above - below) / (2 * kStep), g.x0_mm[s], 0.05 * std::abs(g.x0_mm[s]) + 1e-2 * brightest);
    ++checked;
  }
  EXPECT_GT(checked, 0U);
}

std::string refusal_of(const char* light) {
  const Json content = Json::parse(light);
  JsonObject json(content, "bench.json: lights[0]");
  try {
    read_lamp_size(json, {0, 0, 250});
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(LampSize, SizesThatMakeNoSenseAreErrorsWithWords) {
  EXPECT_THAT(refusal_of(R"({"panel_mm": [300, 200]})"),
              testing::AllOf(testing::HasSubstr("bench.json: lights[0]"), testing::HasSubstr("300 mm"),
                             testing::HasSubstr("250 mm away")));
  EXPECT_THAT(refusal_of(R"({"disk_mm": -1})"), testing::HasSubstr("negative"));
  EXPECT_THAT(refusal_of(R"({"panel_mm": [0, 20]})"), testing::HasSubstr("not positive"));
  EXPECT_THAT(refusal_of(R"({"panel_mm": [30, 20], "disk_mm": 5})"), testing::HasSubstr("keep one"));
  EXPECT_THAT(refusal_of(R"({"panel_mm": [30, 20], "panel_sigma_mm": [-1, 2]})"), testing::HasSubstr("negative"));
  EXPECT_THAT(refusal_of(R"({"panel_mm": [30, 20], "turn_sigma_deg": -1})"), testing::HasSubstr("negative"));
  EXPECT_EQ(refusal_of(R"({"panel_mm": [60, 20], "turn_deg": 12})"), "");
}

TEST(LampSize, WhatPhotosToldOfAPanelIsReadAsItWasWritten) {
  LampSize told;
  told.panel_mm << 120, 60;
  told.turn_deg = -15;
  EXPECT_FALSE(told.is_measured());
  told.panel_sigma_mm = Eigen::Vector2d(2, 3);
  told.turn_sigma_deg = 1.5;
  Json content = Json::object();
  put_lamp_size(told, content);
  JsonObject json(content, "bench.json: lights[0]");
  const LampSize read = read_lamp_size(json, {0, 0, 500});
  EXPECT_EQ(read.panel_mm, told.panel_mm);
  EXPECT_EQ(read.turn_deg, told.turn_deg);
  ASSERT_TRUE(read.is_measured() && read.panel_sigma_mm && read.turn_sigma_deg);
  EXPECT_EQ(*read.panel_sigma_mm, *told.panel_sigma_mm);
  EXPECT_EQ(*read.turn_sigma_deg, *told.turn_sigma_deg);
}

}  // namespace
}  // namespace burin
