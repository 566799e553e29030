// Proves: a lamp's area and the numbers that fits move are the same thing (their second moments, by brute force; there
// and back; slopes against differences), and what is no lamp's size is kept from being one. Paper under a panel is lit
// by the mean of its points. Not proved: that photos tell sides (refine_panel_test.cpp).
#include "burin/calib/light/lamp_area.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "burin/calib/light/lamp_model.h"
#include "burin/scene/lamp_size.h"

namespace burin {
namespace {

constexpr double kUnitMm = 15;

LampSize panel(double longer_mm, double shorter_mm, double turn_deg) {
  LampSize out;
  out.panel_mm << longer_mm, shorter_mm;
  out.turn_deg = turn_deg;
  return out;
}

TEST(LampArea, AreTwiceTheSecondMomentsOfAnEvenlyLitArea) {
  constexpr int kSide = 200;
  const LampSize size = panel(120, 60, 25);
  const LampArea area = lamp_area(size, kUnitMm);
  const double turn = size.turn_deg * std::numbers::pi / 180;
  double xx = 0, yy = 0, xy = 0;
  for (int i = 0; i < kSide; ++i)
    for (int j = 0; j < kSide; ++j) {
      const double a = 120 * ((i + 0.5) / kSide - 0.5), b = 60 * ((j + 0.5) / kSide - 0.5);
      const double x = a * std::cos(turn) - b * std::sin(turn), y = a * std::sin(turn) + b * std::cos(turn);
      xx += x * x;
      yy += y * y;
      xy += x * y;
    }
  const double scale = 2 / (kSide * kSide * kUnitMm * kUnitMm);
  EXPECT_NEAR(area.size2, scale * (xx + yy), 1e-3 * area.size2);
  EXPECT_NEAR(area.sides2[0], scale * (xx - yy), 1e-3 * area.size2);
  EXPECT_NEAR(area.sides2[1], scale * 2 * xy, 1e-3 * area.size2);
}

TEST(LampArea, ThereAndBack) {
  for (const double turn : {-80., -30., 0., 45., 89.}) {
    const LampSize back = lamp_size(lamp_area(panel(90, 40, turn), kUnitMm), kUnitMm, 600);
    EXPECT_NEAR(back.panel_mm.x(), 90, 1e-9);
    EXPECT_NEAR(back.panel_mm.y(), 40, 1e-9);
    EXPECT_NEAR(back.turn_deg, turn, 1e-9);
    EXPECT_EQ(back.disk_mm, 0);
  }
  // The longer side comes first.
  const LampSize across = lamp_size(lamp_area(panel(40, 90, 10), kUnitMm), kUnitMm, 600);
  EXPECT_NEAR(across.panel_mm.x(), 90, 1e-9);
  EXPECT_NEAR(across.turn_deg, -80, 1e-9);
  LampSize disk;
  disk.disk_mm = 22;
  EXPECT_NEAR(lamp_size(lamp_area(disk, kUnitMm), kUnitMm, 600).disk_mm, 22, 1e-9);
  EXPECT_TRUE(lamp_size(lamp_area({}, kUnitMm), kUnitMm, 600).is_point());
}

TEST(LampArea, WhatNoLampHasIsTheNearestThatOneMayHave) {
  EXPECT_TRUE(lamp_size({-1, {0.3, 0}}, kUnitMm, 600).is_point());
  const LampSize line = lamp_size({4, {0, 9}}, kUnitMm, 600);  // sides differ by more than both are
  EXPECT_NEAR(line.panel_mm.y() / line.panel_mm.x(), 0.05, 1e-3);
  EXPECT_NEAR(line.turn_deg, 45, 1e-9);
  EXPECT_NEAR(lamp_size({1e6, {}}, kUnitMm, 600).disk_mm, 270, 1e-9);
  EXPECT_NEAR(lamp_size({1e6, {1, 0}}, kUnitMm, 600).panel_mm.maxCoeff(), 540, 1e-9);
}

TEST(LampArea, SlopesAreDifferences) {
  const LampArea at = lamp_area(panel(90, 40, 20), kUnitMm);
  const auto slopes = panel_slopes(at, kUnitMm);
  constexpr double kStep = 1e-5;
  for (std::size_t k = 0; k < 3; ++k) {
    LampArea above = at, below = at;
    (k == 0 ? above.size2 : above.sides2[k - 1]) += kStep;
    (k == 0 ? below.size2 : below.sides2[k - 1]) -= kStep;
    const LampSize a = lamp_size(above, kUnitMm, 600), b = lamp_size(below, kUnitMm, 600);
    EXPECT_NEAR(slopes[0][k], (a.panel_mm.x() - b.panel_mm.x()) / (2 * kStep), 1e-5);
    EXPECT_NEAR(slopes[1][k], (a.panel_mm.y() - b.panel_mm.y()) / (2 * kStep), 1e-5);
    EXPECT_NEAR(slopes[2][k], (a.turn_deg - b.turn_deg) / (2 * kStep), 1e-5);
  }
}

// By thousands of points, each a spot of the panel's axis; a point in the middle would be 5 % off.
TEST(LampArea, PaperUnderAPanelIsLitByAllOfIt) {
  Light lamp;
  lamp.position_mm << -110, 290, 560;
  lamp.axis = (Eigen::Vector3d(60, 50, 0) - lamp.position_mm).normalized();
  lamp.size = panel(300, 200, 15);
  LampModel<double> model{lamp.position_mm, 3, {60, 50}, 2.5};
  LightSample sample;
  sample.p_board << 100, 12, 0.1;
  sample.normal << 0, 0, 1;
  constexpr int kSide = 60;
  double sum = 0;
  const auto across = across_axis(lamp.axis, lamp.size.turn_deg);
  for (int i = 0; i < kSide; ++i)
    for (int j = 0; j < kSide; ++j) {
      const Eigen::Vector2d at(300 * ((i + 0.5) / kSide - 0.5), 200 * ((j + 0.5) / kSide - 0.5));
      const Eigen::Vector3d to = lamp.position_mm + across * at - sample.p_board;
      const double beam = lamp.axis.dot(-to.normalized());
      sum += std::exp(3) * std::pow(beam, 2.5) * to.normalized().z() / to.squaredNorm();
    }
  const double exact = 0.8 * (1e-6 * sample.around + sum / (kSide * kSide) / std::numbers::pi);
  EXPECT_NEAR(paper_radiance(model, 1e-6, 0.8, sample, lamp_points(lamp)) / exact, 1, 1e-3);
  EXPECT_GT(std::abs(paper_radiance(model, 1e-6, 0.8, sample) / exact - 1), 5e-3);
}

}  // namespace
}  // namespace burin
