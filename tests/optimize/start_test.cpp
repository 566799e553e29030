// Proves that the light model which starts and relocations rest on agrees with the renderer, that the gains it claims
// are the changes of its own error, and that strokes lie where they may. That it helps a design is design_test's part.
#include "optimize/start.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

namespace burin {
namespace {

constexpr double kSize = 60;
constexpr int kPixels = 48;

ViewScene scene_of(const GlintView& glint) {
  ViewScene scene;
  scene.grid = board_grid({0, 0}, {kSize, kSize}, kPixels, kPixels, {{kSize, kSize}, {0, 0, 0}});
  scene.camera_center_mm = glint.camera_mm;
  scene.light.position_mm = glint.light_mm;
  scene.material.alpha = 0.05;
  scene.material.depth_um = 20;
  scene.material.base_alpha = 0.05;
  return scene;
}

const GlintView kLeft{"left", {-200, 30, 500}, {30, -300, 600}}, kRight{"right", {260, 30, 500}, {30, -300, 600}};

StrokeRules rules() {
  StrokeRules r;
  r.min_mm = {0, 0};
  r.max_mm = {kSize, kSize};
  r.shortest_mm = 3;
  r.longest_mm = 12;
  r.alpha = 0.05;
  return r;
}

std::vector<StrokeView> two_views() {
  std::vector<StrokeView> views;
  for (const GlintView& glint : {kLeft, kRight}) {
    ViewRenderer renderer(scene_of(glint));
    StrokeView view{glint, Image(kPixels, kPixels, 1, 0.4F), Image(kPixels, kPixels, 1, 1.0F),
                    measure_units(renderer, glint, {0, 0}, {kSize, kSize})};
    // Of white 1, a full scratch gives half.
    const float mean = std::accumulate(view.unit.data.begin(), view.unit.data.end(), 0.0F) / (kPixels * kPixels);
    for (float& u : view.unit.data) u *= 0.5F / mean;
    for (int y = 0; y < kPixels; ++y)
      for (int x = 0; x < kPixels / 2; ++x) view.missing.at(x, y) = glint.name == "left" ? 0.1F : 0.8F;
    views.push_back(std::move(view));
  }
  return views;
}

double weighted_error(const std::vector<StrokeView>& views) {
  double sum = 0;
  for (const StrokeView& v : views)
    for (std::size_t i = 0; i < v.missing.data.size(); ++i)
      sum += static_cast<double>(v.weight.data[i]) * v.missing.data[i] * v.missing.data[i];
  return sum;
}

Scratches as_scratches(const std::vector<Stroke>& strokes) {
  Scratches s;
  for (const Stroke& k : strokes) {
    s.x0_mm.push_back(k.a_mm.x());
    s.y0_mm.push_back(k.a_mm.y());
    s.x1_mm.push_back(k.b_mm.x());
    s.y1_mm.push_back(k.b_mm.y());
  }
  return s;
}

TEST(Start, ModelAgreesWithTheRendererOnTurnedScratches) {
  ViewRenderer renderer(scene_of(kLeft));
  const Image unit = measure_units(renderer, kLeft, {0, 0}, {kSize, kSize});
  for (const double turn : {0.0, 0.05, -0.1, 0.2}) {
    const Eigen::Vector2d middle(21, 37);
    const Lean lean = lean_at(kLeft, {middle.x(), middle.y(), 0});
    const double direction = lean.scratch_direction() + turn;
    const Eigen::Vector2d half = 4 * Eigen::Vector2d(std::cos(direction), std::sin(direction));
    const Scratches one = as_scratches({{middle - half, middle + half, 0}});
    Image radiance;
    renderer.forward_with_jacobian(one, radiance);
    std::vector<double> light(1, 0.0);
    renderer.add_contributions(light);
    const int x = static_cast<int>(middle.x() / kSize * kPixels),
              y = static_cast<int>((1 - middle.y() / kSize) * kPixels);
    // The lobe's closed form is first order in alpha, and light and lean change a little along 8 mm.
    EXPECT_NEAR(light[0] / (8 * unit.at(x, y) * lobe(lean.angle, turn, 0.05)), 1, 0.06) << "turn " << turn;
  }
}

TEST(Start, GainsAreTheFallOfTheError) {
  std::vector<StrokeView> views = two_views();
  const double before = weighted_error(views);
  const std::vector<Stroke> strokes = place_strokes(views, rules(), 150, 3);
  ASSERT_EQ(strokes.size(), 150U);
  double gains = 0;
  for (const Stroke& s : strokes) {
    EXPECT_GT(s.gain, 0);
    gains += s.gain;
    const double length = (s.b_mm - s.a_mm).norm();
    EXPECT_GE(length, 3 - 1e-9);
    EXPECT_LE(length, 12 + 1e-9);
    for (const double c : {s.a_mm.x(), s.a_mm.y(), s.b_mm.x(), s.b_mm.y()}) {
      EXPECT_GE(c, -1e-9);
      EXPECT_LE(c, kSize + 1e-9);
    }
  }
  EXPECT_NEAR(before - weighted_error(views), gains, 1e-3 * before);
  EXPECT_LT(weighted_error(views), 0.7 * before);
}

TEST(Start, WorthIsTheRiseOfTheErrorWhenLifted) {
  std::vector<StrokeView> views = two_views();
  const Scratches scratches = as_scratches(place_strokes(views, rules(), 120, 4));
  const std::vector<double> worth = worth_of(views, rules(), scratches);
  const double before = weighted_error(views);
  for (const std::size_t i : {0U, 17U, 119U}) {
    std::vector<StrokeView> lifted = views;
    lift_stroke(lifted, rules(), scratches, i);
    EXPECT_NEAR(weighted_error(lifted) - before, worth[i], 1e-4 * before);
  }
}

TEST(Start, SameSeedSameStrokes) {
  std::vector<StrokeView> a = two_views(), b = two_views(), c = two_views();
  const auto first = place_strokes(a, rules(), 20, 5), again = place_strokes(b, rules(), 20, 5),
             other = place_strokes(c, rules(), 20, 6);
  EXPECT_EQ(first[19].a_mm, again[19].a_mm);
  EXPECT_NE(first[19].a_mm, other[19].a_mm);
}

TEST(Start, NothingToGainPlacesNothing) {
  std::vector<StrokeView> views = two_views();
  for (StrokeView& v : views) std::fill(v.missing.data.begin(), v.missing.data.end(), -0.1F);
  EXPECT_TRUE(place_strokes(views, rules(), 10, 1).empty());
}

}  // namespace
}  // namespace burin
