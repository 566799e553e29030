// Proves that the light model which starts and relocations rest on agrees with the renderer, that the gains it claims
// are the changes of its own error, and that strokes lie where they may. That it helps a design is design_test's part.
#include "burin/optimize/design/stroke_search.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <numeric>

namespace burin {
namespace {

constexpr double kSize = 60;
constexpr int kPixels = 48;

ViewScene scene_of(const GlintView& glint) {
  ViewScene scene;
  scene.grid = share(board_grid({0, 0}, {kSize, kSize}, kPixels, kPixels, {{kSize, kSize}, {0, 0, 0}}));
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

// Dim on one half, bright on the other; the views disagree on which.
std::vector<StrokeView> two_views() {
  std::vector<StrokeView> views;
  for (const GlintView& glint : {kLeft, kRight}) {
    ViewRenderer renderer(scene_of(glint));
    StrokeView view{glint,
                    Image(kPixels, kPixels, 1, 0.02F),
                    Image(kPixels, kPixels, 1, 0.6F),
                    {},
                    measure_units(renderer, glint, {0, 0}, {kSize, kSize})};
    // Of white 1, a full scratch gives half.
    const float mean = std::accumulate(view.unit.data.begin(), view.unit.data.end(), 0.0F) / (kPixels * kPixels);
    for (float& u : view.unit.data) u *= 0.5F / mean;
    for (int y = 0; y < kPixels; ++y)
      for (int x = 0; x < kPixels / 2; ++x) view.target.at(x, y) = glint.name == "left" ? 0.3F : 0.9F;
    views.push_back(std::move(view));
  }
  return views;
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

TEST(StrokeSearch, ModelAgreesWithTheRendererOnTurnedScratches) {
  ViewRenderer renderer(scene_of(kLeft));
  const Image unit = measure_units(renderer, kLeft, {0, 0}, {kSize, kSize});
  for (const double turn : {0.0, 0.05, -0.1, 0.2}) {
    const Eigen::Vector2d middle(21, 37);
    const Lean lean = lean_at(kLeft, {middle.x(), middle.y(), 0});
    const double direction = lean.scratch_direction() + turn;
    const Eigen::Vector2d half = 4 * Eigen::Vector2d(std::cos(direction), std::sin(direction));
    const Scratches one = as_scratches({{middle - half, middle + half, 0}});
    Image radiance;
    renderer.forward_with_jacobian(in_metal(one), radiance);
    std::vector<double> light(1, 0.0);
    renderer.add_contributions(light);
    const int x = static_cast<int>(middle.x() / kSize * kPixels),
              y = static_cast<int>((1 - middle.y() / kSize) * kPixels);
    // The lobe's closed form is first order in alpha, and light and lean change a little along 8 mm.
    EXPECT_NEAR(light[0] / (8 * unit.at(x, y) * lobe(lean.angle, turn, 0.05)), 1, 0.06) << "turn " << turn;
  }
}

TEST(StrokeSearch, ModelTellsEveryPixelOfAnyNumberOfScratches) {
  // 150 strokes of all directions near the best one, grooves a thirtieth of a pixel wide: pixel by pixel.
  std::vector<StrokeView> views = two_views();
  const Scratches scratches = as_scratches(place_strokes(views, rules(), 150, 3));
  for (StrokeView& view : two_views()) {
    ViewScene scene = scene_of(view.glint);
    scene.tool_width_um = 100;
    ViewRenderer renderer(scene);
    Image face, shown;
    renderer.forward({}, face);
    renderer.forward(in_metal(scratches), shown);
    const float pixel_mm = static_cast<float>(kSize / kPixels);
    view.unit = measure_units(renderer, view.glint, {0, 0}, {kSize, kSize});
    for (float& u : view.unit.data) u *= pixel_mm;
    view.light = face;
    const Image before = face;
    std::vector<StrokeView> one{view};
    std::vector<std::size_t> all(scratches.size()), mine;
    std::iota(all.begin(), all.end(), 0U);
    // Only those meant for this view are told; the other view's add little here.
    for (const std::size_t i : all) {
      const Lean lean = lean_at(view.glint, {scratches.x0_mm[i], scratches.y0_mm[i], 0});
      const double angle = std::atan2(scratches.y1_mm[i] - scratches.y0_mm[i], scratches.x1_mm[i] - scratches.x0_mm[i]);
      if (lobe(lean.angle, angle - lean.scratch_direction(), 0.05) > 0.02) mine.push_back(i);
    }
    add_strokes(one, rules(), scratches, mine);
    double error = 0, light = 0;
    for (std::size_t i = 0; i < shown.data.size(); ++i) {
      error += std::pow(one[0].light.data[i] - shown.data[i], 2);
      light += std::pow(shown.data[i] - before.data[i], 2);
    }
    EXPECT_LT(std::sqrt(error / light), 0.12) << view.glint.name;
  }
}

TEST(StrokeSearch, GainsAreTheFallOfTheError) {
  std::vector<StrokeView> views = two_views();
  const double before = squared_error(views);
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
  // Of the same table and pixels, but summed another way.
  EXPECT_NEAR(before - squared_error(views), gains, 2e-3 * before);
  EXPECT_LT(squared_error(views), 0.7 * before);
}

TEST(StrokeSearch, WorthIsTheRiseOfTheErrorWhenLifted) {
  std::vector<StrokeView> views = two_views();
  const Scratches scratches = as_scratches(place_strokes(views, rules(), 120, 4));
  const std::vector<double> worth = worth_of(views, rules(), scratches);
  const double before = squared_error(views);
  for (const std::size_t i : {0U, 17U, 119U}) {
    std::vector<StrokeView> lifted = views;
    lift_strokes(lifted, rules(), scratches, {i});
    EXPECT_NEAR(squared_error(lifted) - before, worth[i], 1e-4 * before);
    add_strokes(lifted, rules(), scratches, {i});
    EXPECT_NEAR(squared_error(lifted), before, 1e-4 * before);
  }
}

TEST(StrokeSearch, SweepsLowerTheErrorAndLeaveWhatMayNotMove) {
  std::vector<StrokeView> views = two_views();
  Scratches scratches = as_scratches(place_strokes(views, rules(), 150, 4));
  const Scratches before = scratches;
  double error = squared_error(views);
  const double placed = error;
  for (int sweep = 0; sweep < 3; ++sweep) {
    const std::vector<std::size_t> moved = improve_strokes(views, rules(), scratches, 100, 7 + sweep);
    EXPECT_FALSE(moved.empty());
    EXPECT_LT(squared_error(views), error);
    error = squared_error(views);
  }
  EXPECT_LT(error, 0.95 * placed);
  for (std::size_t i = 100; i < 150; ++i) EXPECT_EQ(scratches.x0_mm[i], before.x0_mm[i]);
}

TEST(StrokeSearch, StopsWithinASweepAndLeavesAllAsItShows) {
  std::vector<StrokeView> views = two_views();
  const double empty = squared_error(views);
  EXPECT_TRUE(place_strokes(views, rules(), 150, 4, [] { return true; }).empty());
  EXPECT_EQ(squared_error(views), empty);
  Scratches scratches = as_scratches(place_strokes(views, rules(), 150, 4));
  const Scratches before = scratches;
  // One thread, so that the first view's sweep asks three times before the second's ends at once.
  tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  int asked = 0;
  const auto moved = improve_strokes(views, rules(), scratches, 150, 7, [&] { return ++asked > 2; });
  EXPECT_FALSE(moved.empty());
  EXPECT_LE(moved.size(), 32U);  // 16 strokes between two questions
  EXPECT_LE(asked, 4);
  std::size_t differ = 0;
  for (std::size_t i = 0; i < 150; ++i) differ += scratches.x0_mm[i] != before.x0_mm[i] ? 1 : 0;
  EXPECT_EQ(differ, moved.size());
  // The light follows what was moved: without all of it, nothing is left.
  std::vector<std::size_t> all(150);
  std::iota(all.begin(), all.end(), std::size_t{0});
  lift_strokes(views, rules(), scratches, all);
  EXPECT_NEAR(squared_error(views), empty, 1e-4 * empty);
}

TEST(StrokeSearch, WhatIsMaskedAttractsNothing) {
  std::vector<StrokeView> views = two_views();
  for (StrokeView& v : views) {
    v.mask = Image(kPixels, kPixels, 1, 1.0F);
    for (int y = 0; y < kPixels / 2; ++y)
      for (int x = 0; x < kPixels; ++x) v.mask.at(x, y) = 0;  // the upper half
  }
  // Its own pixels are of no use there, so no end lies more than a pixel inside.
  for (const Stroke& s : place_strokes(views, rules(), 100, 5))
    EXPECT_LT(std::max(s.a_mm.y(), s.b_mm.y()), kSize / 2 + kSize / kPixels);
}

TEST(StrokeSearch, SameSeedSameStrokes) {
  std::vector<StrokeView> a = two_views(), b = two_views(), c = two_views();
  const auto first = place_strokes(a, rules(), 20, 5), again = place_strokes(b, rules(), 20, 5),
             other = place_strokes(c, rules(), 20, 6);
  EXPECT_EQ(first[19].a_mm, again[19].a_mm);
  EXPECT_NE(first[19].a_mm, other[19].a_mm);
}

TEST(StrokeSearch, NothingToGainPlacesNothing) {
  std::vector<StrokeView> views = two_views();
  for (StrokeView& v : views) std::fill(v.light.data.begin(), v.light.data.end(), 0.9F);
  EXPECT_TRUE(place_strokes(views, rules(), 10, 1).empty());
}

}  // namespace
}  // namespace burin
