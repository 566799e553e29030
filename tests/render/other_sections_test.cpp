// Grooves of other cross-sections than the paper's on the fast path (docs/model.md 8.6) against the double twin.
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "burin/base/simd_choice.h"
#include "burin/render/scene_parts.h"
#include "burin/scene/crossings.h"
#include "tests/render/small_world.h"

namespace burin {
namespace {

// A board of 60 mm with 80 x 80 pixels, seen and lit from half a meter, or `farther`; half of the scratches are turned
// so that they shine.
World bench_of_grooves(double alpha, double across, bool burrs, double farther = 1) {
  World w;
  w.board.size_mm = {60, 60};
  w.board.tool_width_um = 1280;
  w.scene.grid =
      share(board_grid(Eigen::Vector2d(0, 0), Eigen::Vector2d(60, 60), 80, 80, {w.board.size_mm, {0, 0, 0}}));
  const Eigen::Vector3d middle(30, 30, 0);
  w.scene.camera_center_mm = middle + farther * Eigen::Vector3d(130, 10, 480);
  w.scene.light.position_mm = middle + farther * Eigen::Vector3d(-70, -210, 430);
  w.scene.light.intensity = farther * farther * Eigen::Vector3d(900, 700, 800);
  w.scene.light.axis = Eigen::Vector3d(70, 210, -430).normalized();
  w.scene.light.falloff_exponent = 3;
  w.scene.ambient = {1e-5, 2e-5, 3e-5};
  w.scene.tool_width_um = 1280;
  w.scene.material = {alpha, 48, 0.18, {0.91, 0.92, 0.6}};
  GrooveProfile& profile = w.scene.material.profile;
  profile.kind = GrooveProfile::Kind::rounded_v;
  profile.flank_deg = 24;
  profile.burr_width_um = 40;
  if (burrs) {
    profile.burr_left_um = 5;
    profile.burr_right_um = 3;
  }
  profile.across = across;
  const Eigen::Vector3d half =
      ((w.scene.camera_center_mm - middle).normalized() + (w.scene.light.position_mm - middle).normalized())
          .normalized();
  const double shining = std::atan2(half.y(), half.x()) + std::numbers::pi / 2;
  std::mt19937 random(5);
  std::uniform_real_distribution<double> where(8, 52), turn(0, 2 * std::numbers::pi), length(0.3, 14), off(-0.06, 0.06);
  for (int i = 0; i < 60; ++i) {
    const double a = i % 2 == 0 ? turn(random) : shining + off(random), l = 0.5 * length(random);
    const double x = where(random), y = where(random);
    w.scratches.x0_mm.push_back(x - l * std::cos(a));
    w.scratches.y0_mm.push_back(y - l * std::sin(a));
    w.scratches.x1_mm.push_back(x + l * std::cos(a));
    w.scratches.y1_mm.push_back(y + l * std::sin(a));
  }
  return w;
}

/// How far the fast path is from the twin with bands of 1 um: RMS over the image's peak, and of each derivative.
struct TwinErrors {
  double image = 0, contributions = 0;
  std::vector<std::pair<std::string, double>> gradients;
};
TwinErrors twin_errors(const World& w, int channels, SimdWidth simd) {
  const Image weights = random_weights(w, channels, 9);
  RenderOptions options{channels};
  options.simd = simd;
  ViewRenderer fast(w.scene, options);
  Image image, value_only, expected;
  fast.forward(in_metal(w.scratches), value_only);
  fast.forward_with_jacobian(in_metal(w.scratches), image);
  ScratchGradients g, ge;
  for (ScratchGradients* of : {&g, &ge}) of->resize(w.scratches.size());
  fast.backward(weights, g);
  std::vector<double> sent(w.scratches.size(), 0), sent_expected = sent;
  fast.add_contributions(sent);
  for (ScenePart& part : scene_parts(w.scene)) {
    part.scene.light.intensity *= part.share;
    if (!expected.data.empty()) part.scene.ambient.setZero();
    const ViewPixels pixels = view_pixels(part.scene, channels);
    ExactView exact(part.scene, pixels, 1);
    Image one;
    exact.forward(w.scratches,
                  find_pairs(PixelIndex(*w.scene.grid), w.scene.grid->width(), w.scene.grid->height(),
                             strips_of(w.scratches, w.scene.tool_width_um, w.scene.material)),
                  true, one);
    exact.backward(weights, ge);
    exact.add_contributions(sent_expected);
    add_share(one, 1, expected);
  }
  TwinErrors errors;
  double peak = 0, error2 = 0;
  for (std::size_t i = 0; i < image.data.size(); ++i) {
    EXPECT_NEAR(value_only.data[i], image.data[i], 1e-6F + 1e-5F * image.data[i]);
    peak = std::max<double>(peak, expected.data[i]);
    error2 += std::pow(static_cast<double>(image.data[i]) - expected.data[i], 2);
  }
  errors.image = std::sqrt(error2 / static_cast<double>(image.data.size())) / peak;
  errors.contributions = relative_rms(sent, sent_expected);
  errors.gradients = {{"x0", relative_rms(g.x0_mm, ge.x0_mm)},          {"y0", relative_rms(g.y0_mm, ge.y0_mm)},
                      {"x1", relative_rms(g.x1_mm, ge.x1_mm)},          {"y1", relative_rms(g.y1_mm, ge.y1_mm)},
                      {"depth", relative_rms(g.depth_um, ge.depth_um)}, {"alpha", relative_rms(g.alpha, ge.alpha)}};
  if (w.scene.material.profile.tip_radius_um == 0)
    errors.gradients.emplace_back("width", relative_rms(g.width_um, ge.width_um));
  else
    EXPECT_EQ(*std::max_element(g.width_um.begin(), g.width_um.end()), 0);
  errors.gradients.emplace_back("base_alpha", std::abs(g.shared_base_alpha / ge.shared_base_alpha - 1));
  return errors;
}

void expect_as_twin(const World& w, const std::string& what, double image = 2e-4, double gradient = 2e-2,
                    int channels = 1, SimdWidth simd = SimdWidth::best) {
  const TwinErrors errors = twin_errors(w, channels, simd);
  EXPECT_LT(errors.image, image) << what;
  EXPECT_LT(errors.contributions, 2e-3) << what;
  for (const auto& [name, error] : errors.gradients) EXPECT_LT(error, gradient) << what << ": by " << name;
}

// Widths, depths and roughnesses of their own.
void vary(World& w, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> factor(0.7, 1.4);
  const Material& m = w.scene.material;
  for (std::size_t i = 0; i < w.scratches.size(); ++i) {
    w.scratches.width_um.push_back(w.scene.tool_width_um * factor(random));
    w.scratches.depth_um.push_back(m.depth_um * factor(random));
    w.scratches.alpha.push_back(m.alpha * factor(random));
  }
}

TEST(OtherSections, AreThoseOfTheDoubleTwin) {
  for (const double alpha : {0.03, 0.15})
    for (const double across : {0.7, 1.43})
      for (const bool burrs : {false, true}) {
        // From far away light is the same all over a pixel; from near it is found where the groove lies in it, and by
        // the twin in the pixel's middle.
        expect_as_twin(bench_of_grooves(alpha, across, burrs, 20), "far away", 3e-5, 3e-3);
        World w = bench_of_grooves(alpha, across, burrs);
        const std::string what = "alpha " + std::to_string(alpha) + ", across " + std::to_string(across) +
                                 (burrs ? ", with burrs" : ", without burrs");
        expect_as_twin(w, what);
        w.scratches = visible_pieces(w.scratches, w.scene.tool_width_um, w.scene.material.depth_um,
                                     w.scene.material.profile, Crossings::deepest)
                          .pieces;
        expect_as_twin(w, what + ", cut where they cross");
      }
}

TEST(OtherSections, OfDifferentGroovesAndTips) {
  for (const double tip_radius_um : {0.0, 250.0})
    for (const auto kind : {GrooveProfile::Kind::paper, GrooveProfile::Kind::rounded_v}) {
      World w = bench_of_grooves(0.08, 1.2, true);
      w.scene.material.profile.kind = kind;
      w.scene.material.profile.tip_radius_um = tip_radius_um;
      vary(w, 3);
      expect_as_twin(w, "tip " + std::to_string(tip_radius_um));
    }
}

TEST(OtherSections, InColorAndUnderALampWithAnArea) {
  World w = bench_of_grooves(0.06, 1.43, true);
  expect_as_twin(w, "in color", 2e-4, 2e-2, 3);
  w.scene.light.size.disk_mm = 15;
  expect_as_twin(w, "under a disk");
  w.scene.light.size = {};
  w.scene.light.size.panel_mm = {60, 20};
  expect_as_twin(w, "under a panel, in color", 2e-4, 2e-2, 3);
}

TEST(OtherSections, AreTheSameForAllPackets) {
  for (const SimdWidth simd : {SimdWidth::generic, SimdWidth::avx2}) {
    if (!has_kernel(simd)) continue;
    expect_as_twin(bench_of_grooves(0.06, 1.43, true), "near", 2e-4, 2e-2, 1, simd);
    expect_as_twin(bench_of_grooves(0.03, 0.7, true, 20), "far away", 3e-5, 3e-3, 1, simd);
  }
}

// A lamp so near that half vectors turn about over a tile goes pair by pair.
TEST(OtherSections, GoPairByPairWhereHalfVectorsBend) {
  World w = bench_of_grooves(0.03, 1, true);
  w.scene.light.position_mm = {25, 31, 6};
  w.scene.light.falloff_exponent = 0;
  ViewRenderer fast(w.scene, {}), exact(w.scene, {1, true});
  Image image, expected;
  fast.forward(in_metal(w.scratches), image);
  exact.forward(in_metal(w.scratches), expected);
  EXPECT_EQ(image.data, expected.data);
}

// The twin's derivative by the width: burrs keep theirs, and a tip of its own makes a section that does not know it.
TEST(OtherSections, DerivativesByWidthAreDifferences) {
  for (const double tip_radius_um : {0.0, 250.0}) {
    World w = bench_of_grooves(0.08, 1.2, true);
    w.scene.material.profile.tip_radius_um = tip_radius_um;
    vary(w, 4);
    const ViewPixels pixels = view_pixels(w.scene, 1);
    const PixelIndex index(*w.scene.grid);
    const Image weights = random_weights(w, 1, 9);
    ViewRenderer exact(w.scene, {1, true});
    Image image;
    exact.forward_with_jacobian(in_metal(w.scratches), image);
    const ScratchGradients gradients = exact.backward(weights);
    for (std::size_t i = 0; i < 12; ++i) {
      constexpr double kStep_um = 0.05;
      World wider = w, narrower = w;
      wider.scratches.width_um[i] += kStep_um;
      narrower.scratches.width_um[i] -= kStep_um;
      const double difference =
          (weighted_sum(wider, pixels, index, weights) - weighted_sum(narrower, pixels, index, weights)) /
          (2 * kStep_um);
      EXPECT_NEAR(gradients.width_um[i], difference, 1e-4 * std::abs(difference) + 1e-11) << tip_radius_um << ", " << i;
    }
  }
}

}  // namespace
}  // namespace burin
