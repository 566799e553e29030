// Proves the closed forms of glints (lobe and reach) against direct numerical integration of the GGX lobe over a
// groove's wall, and that the checks of a bench say what is wrong and by how much.
#include "burin/optimize/design/glint.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "burin/base/error.h"
#include "burin/optimize/design/glint_check.h"
#include "burin/render/brdf.h"
#include "burin/scene/groove.h"

namespace burin {
namespace {

GrooveAt grooves(double depth_um, double alpha) {
  return [=](const Eigen::Vector2d&) { return GrooveShape{depth_um, alpha}; };
}

using testing::HasSubstr;

// Integral of D over the slope angle of a wall that ends at `steepest`; h leans by `lean`, turned by `turn` from the
// plane across the groove.
double wall_integral(double lean, double turn, double steepest, double alpha) {
  const int n = 20000;
  double sum = 0;
  for (int i = 0; i < n; ++i) {
    const double slope = steepest * (2 * (i + 0.5) / n - 1);
    const double nh = std::sin(slope) * std::sin(lean) * std::cos(turn) + std::cos(slope) * std::cos(lean);
    sum += ggx_D(nh, alpha);
  }
  return sum * 2 * steepest / n;
}

TEST(Glint, LobeMatchesIntegration) {
  // The closed form is first order in alpha and the turn: a few per cent at alpha 0.04.
  for (const double turn : {0.0, 0.05, 0.1, 0.2}) {
    const double expected = wall_integral(0.35, turn, 1.2, 0.04) / wall_integral(0.35, 0, 1.2, 0.04);
    EXPECT_NEAR(lobe(0.35, turn, 0.04), expected, 0.02) << turn;
  }
  EXPECT_NEAR(lobe(0.35, turn_for(0.35, 0.3, 0.04), 0.04), 0.3, 1e-12);
  EXPECT_EQ(turn_for(0.01, 0.001, 0.5), std::numbers::pi / 2);  // everything glints near the mirror direction
}

TEST(Glint, ReachMatchesIntegration) {
  const double steepest = 0.45;
  for (const double lean : {0.3, 0.4, 0.45, 0.5, 0.6}) {
    const double expected = wall_integral(lean, 0, steepest, 0.04) / wall_integral(lean, 0, 1.5, 0.04);
    EXPECT_NEAR(reach(lean, steepest, 0.04), expected, 0.01) << lean;
  }
}

TEST(Glint, DirectionIsAcrossTheHalfVectorsShadow) {
  const GlintView view{"v", {0, 0, 500}, {300, 0, 400}};
  const Lean lean = lean_at(view, {0, 0, 0});
  EXPECT_NEAR(lean.azimuth, 0, 1e-12);
  EXPECT_NEAR(lean.scratch_direction(), std::numbers::pi / 2, 1e-12);
  EXPECT_NEAR(lean.angle, std::atan2(300, 400) / 2, 1e-12);
}

GlintView at_azimuth(const std::string& name, double azimuth) {
  // Lamp straight above, eye at 50 degrees from the normal: h leans 25 degrees towards the eye.
  return {name,
          {1000 * std::sin(0.873) * std::cos(azimuth), 1000 * std::sin(0.873) * std::sin(azimuth), 643},
          {0, 0, 1000}};
}

TEST(Glint, CollisionsModuloHalfATurnAreNamed) {
  const Eigen::Vector2d min{-20, -20}, max{20, 20};
  const auto apart = check_glints({at_azimuth("a", 0), at_azimuth("b", 1.2)}, min, max, 400, grooves(40, 0.04));
  EXPECT_TRUE(apart.empty());
  const auto opposite =
      check_glints({at_azimuth("a", 0), at_azimuth("b", std::numbers::pi + 0.05)}, min, max, 400, grooves(40, 0.04));
  ASSERT_EQ(opposite.size(), 1U);
  EXPECT_THAT(sentence(opposite[0]), AllOf(HasSubstr("a and b"), HasSubstr("2.9 degrees apart"), HasSubstr("collide")));
}

TEST(Glint, TooShallowGroovesAreAnErrorThatNamesTheDepthNeeded) {
  const GlintView view = at_azimuth("a", 0);
  const Eigen::Vector2d min{-20, -20}, max{20, 20};
  try {
    check_glints({view}, min, max, 400, grooves(1, 0.04));
    FAIL() << "no error";
  } catch (const Error& e) {
    EXPECT_THAT(e.what(),
                AllOf(HasSubstr("view a"), HasSubstr("no groove can glint"), HasSubstr("degrees too little")));
    // The remedy's own depth must pass.
    const std::string text = e.what();
    const double depth = std::stod(text.substr(text.find("at least ") + 9));
    EXPECT_TRUE(check_glints({view}, min, max, 400, grooves(depth * 1.05, 0.04)).empty());
  }
}

TEST(Glint, LampBehindTheBoard) {
  GlintView view = at_azimuth("a", 0);
  view.light_mm.z() = -5;
  EXPECT_THROW(check_glints({view}, {0, 0}, {1, 1}, 400, grooves(40, 0.04)), Error);
}

}  // namespace
}  // namespace burin
