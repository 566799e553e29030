// Light along grooves from a few half vectors (burin/render/footprint/lights_along.h) against light found at each
// pixel.
#include "burin/render/footprint/lights_along.h"

#include <gtest/gtest.h>

#include <string>

#include "burin/render/crossings.h"
#include "tests/render/small_world.h"

namespace burin {
namespace {

// A board of 60 mm with 80 x 80 pixels, seen and lit from half a meter; half of the scratches are turned so that they
// shine.
World bench_with_cut_grooves(double alpha, double across) {
  World w;
  w.board.size_mm = {60, 60};
  w.board.tool_width_um = 128;
  w.scene.grid =
      share(board_grid(Eigen::Vector2d(0, 0), Eigen::Vector2d(60, 60), 80, 80, {w.board.size_mm, {0, 0, 0}}));
  w.scene.camera_center_mm = {160, 40, 480};
  w.scene.light.position_mm = {-40, -180, 430};
  w.scene.light.intensity = {900, 900, 900};
  w.scene.tool_width_um = 128;
  w.scene.material = {alpha, 5.6, 0.18, {0.91, 0.92, 0.6}};
  GrooveProfile& profile = w.scene.material.profile;
  profile.kind = GrooveProfile::Kind::rounded_v;
  profile.flank_deg = 24;
  profile.burr_left_um = 0.5;
  profile.burr_right_um = 0.3;
  profile.burr_width_um = 4;
  profile.across = across;
  const Eigen::Vector3d middle(30, 30, 0);
  const Eigen::Vector3d half =
      ((w.scene.camera_center_mm - middle).normalized() + (w.scene.light.position_mm - middle).normalized())
          .normalized();
  const double shining = std::atan2(half.y(), half.x()) + std::numbers::pi / 2;
  std::mt19937 random(5);
  std::uniform_real_distribution<double> where(8, 52), turn(0, 2 * std::numbers::pi), length(0.3, 14), off(-0.06, 0.06);
  for (int i = 0; i < 240; ++i) {
    const double a = i % 2 == 0 ? turn(random) : shining + off(random), l = 0.5 * length(random);
    const double x = where(random), y = where(random);
    w.scratches.x0_mm.push_back(x - l * std::cos(a));
    w.scratches.y0_mm.push_back(y - l * std::sin(a));
    w.scratches.x1_mm.push_back(x + l * std::cos(a));
    w.scratches.y1_mm.push_back(y + l * std::sin(a));
  }
  return w;
}

void expect_as_by_pixels(const World& w, const std::string& what) {
  const FastErrors errors = fast_errors(w, 1, SimdWidth::best);
  EXPECT_TRUE(errors.same_pairs) << what;
  EXPECT_LT(errors.image, 1e-5) << what;
  EXPECT_LT(errors.value_only, 1e-5) << what;
  EXPECT_LT(errors.contributions, 1e-4) << what;
  for (const auto& [name, error] : errors.gradients) EXPECT_LT(error, 1e-2) << what << ": by " << name;
}

TEST(LightsAlong, AreThoseOfEachPixel) {
  for (const double alpha : {0.02, 0.045, 0.15})
    for (const double across : {0.7, 1.0, 1.43}) {
      World w = bench_with_cut_grooves(alpha, across);
      const std::string what = "alpha " + std::to_string(alpha) + ", across " + std::to_string(across);
      expect_as_by_pixels(w, what);
      w.scratches = visible_pieces(w.scratches, w.scene.tool_width_um, w.scene.material.depth_um,
                                   w.scene.material.profile, Crossings::deepest)
                        .pieces;
      expect_as_by_pixels(w, what + ", cut where they cross");
    }
}

}  // namespace
}  // namespace burin
