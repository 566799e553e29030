// Proves that the search's kernel comes to the same bits at every width, that what it says a stroke gains is what the
// error falls by when the stroke is added, that its ends are the best ones among all along the line, that a stroke's
// pixels are as long as it is, and that tiles, shares and draws leave nothing out.
#include "burin/optimize/design/stroke_kernel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>
#include <random>
#include <utility>
#include <vector>

#include "burin/optimize/design/shown_light.h"
#include "burin/optimize/design/stroke_field.h"
#include "burin/optimize/design/stroke_tiles.h"

namespace burin {
namespace {

constexpr int kSidePixels = 80;

// A view whose pixels are all different; lamp and eye near.
StrokeView kernel_view(bool masked, std::size_t asides, bool costs = false) {
  StrokeView v{{"v", {-200, 30, 500}, {30, -300, 600}},
               Image(kSidePixels, kSidePixels, 1),
               Image(kSidePixels, kSidePixels, 1),
               {},
               Image(kSidePixels, kSidePixels, 1)};
  std::mt19937 random(3);
  const auto number = [&] { return static_cast<float>(random() % 1000) / 1000; };
  for (std::size_t i = 0; i < v.light.data.size(); ++i) {
    v.light.data[i] = 0.1F * number();
    v.target.data[i] = 0.2F + 0.8F * number();
    v.unit.data[i] = 0.4F + 0.1F * number();
  }
  if (masked) {
    v.mask = Image(kSidePixels, kSidePixels, 1);
    for (float& m : v.mask.data) m = number();
  }
  if (costs) {  // of most pixels a tenth of what they gain, of some less than nothing
    v.cost = Image(kSidePixels, kSidePixels, 1);
    for (float& c : v.cost.data) c = 0.05F * number() - 0.01F;
  }
  v.weight = 0.7;
  for (std::size_t k = 0; k < asides; ++k) {
    StrokeAside aside{v.glint, v.light, v.unit, 0.3};
    aside.glint.camera_mm.x() += 10.0 * static_cast<double>(k + 1);
    v.asides.push_back(aside);
  }
  return v;
}

StrokeRules kernel_rules() {
  StrokeRules r;
  r.min_mm = {0, 0};
  r.max_mm = {60, 60};
  r.shortest_mm = 1;
  r.longest_mm = 30;
  r.alpha = 0.05;
  return r;
}

StrokeTries some_tries(unsigned seed) {
  std::mt19937 random(seed);
  const auto number = [&] { return static_cast<float>(random() % 100000) / 100000; };
  StrokeTries t{};
  t.old_x = 0.6F;
  t.old_y = 0.8F;
  for (int i = 0; i < kStrokeLanes; ++i) {
    t.x[i] = kSidePixels * number();
    t.y[i] = kSidePixels * number();
    t.brighter[i] = 0.5F + number();
    t.anywhere[i] = i % 2 == 0 ? 1 : 0;
    t.side[i] = i % 3 == 0 ? -1 : 1;
    t.alpha[i] = 0.05F;
  }
  return t;
}

TEST(StrokeKernel, SameBitsForEveryWidth) {
  for (const bool masked : {false, true})
    for (const std::size_t asides : {0U, 2U})
      for (const bool costs : {false, true}) {
        const StrokeView view = kernel_view(masked, asides, costs);
        const StrokeRules r = kernel_rules();
        const StrokeField field(view, r);
        const StrokeWindow window = field.window(field.whole());
        for (unsigned seed = 1; seed < 20; ++seed) {
          StrokeTries tries = some_tries(seed);
          tries.count = seed % 4 == 0 ? 5 : kStrokeLanes;
          StrokesFound plain{}, other{};
          try_strokes(SimdWidth::generic)(window, tries, plain);
          int found = 0;
          for (int i = 0; i < tries.count; ++i) found += plain.gain[i] > 0 ? 1 : 0;
          EXPECT_GT(found, 0);
          for (int i = tries.count; i < kStrokeLanes; ++i) EXPECT_EQ(plain.gain[i], 0);
          for (const SimdWidth width : {SimdWidth::avx2, SimdWidth::avx512}) {
            if (!has_kernel(width)) continue;
            try_strokes(width)(window, tries, other);
            for (int i = 0; i < tries.count; ++i) {
              EXPECT_EQ(plain.gain[i], other.gain[i]) << name(width) << " lane " << i;
              EXPECT_EQ(plain.ux[i], other.ux[i]);
              EXPECT_EQ(plain.ahead[i], other.ahead[i]);
              EXPECT_EQ(plain.behind[i], other.behind[i]);
            }
          }
        }
      }
}

TEST(StrokeKernel, GainsAreWhatTheErrorFallsByAndNoOtherEndsGainMore) {
  for (const bool masked : {false, true})
    for (const std::size_t asides : {0U, 2U})
      for (const bool costs : {false, true}) {
        const StrokeView view = kernel_view(masked, asides, costs);
        const StrokeRules r = kernel_rules();
        const StrokeField field(view, r);
        const StrokeView free_view = kernel_view(masked, asides);
        const StrokeField free_field(free_view, r);
        StrokesFound found{};
        const StrokeTries tries = some_tries(7);
        try_strokes()(field.window(field.whole()), tries, found);
        for (int i = 0; i < kStrokeLanes; ++i) {
          if (!(found.gain[i] > 0)) continue;
          const Eigen::Vector2d p(tries.x[i], tries.y[i]), u(found.ux[i], found.uy[i]);
          const auto fall = [&](double behind, double ahead) {
            return field.fall(field.board(p + behind * u), field.board(p + ahead * u), 1);
          };
          // Lobes are linear along the stroke here, and along its furthest reach there: 15 mm of half a meter.
          const double free =
              free_field.fall(field.board(p + found.behind[i] * u), field.board(p + found.ahead[i] * u), 1);
          EXPECT_NEAR(fall(found.behind[i], found.ahead[i]), found.gain[i], 0.01 * free) << i;
          // Ends lie on borders of pixels: none of those close to the ones found gains more.
          for (int c = 0; c < 2; ++c)
            for (int n = 0; n <= kSidePixels; ++n) {
              const double s = (n - p[c]) / u[c];
              if (s > 0.01 && std::abs(s - found.ahead[i]) < 3 && s < 0.5 * 30 / 60 * kSidePixels - 2) {
                EXPECT_LT(fall(found.behind[i], s), found.gain[i] + 0.01 * free) << i;
              }
              if (s < -0.01 && std::abs(s - found.behind[i]) < 3 && s > -0.5 * 30 / 60 * kSidePixels) {
                EXPECT_LT(fall(s, found.ahead[i]), found.gain[i] + 0.01 * free) << i;
              }
            }
        }
      }
}

TEST(StrokeKernel, ShownLightIsTheGammaCurve) {
  for (double light = 1e-7; light < 4; light *= 1.037)
    EXPECT_NEAR(shown_light(static_cast<float>(light)), std::min(1.0, std::pow(light, 1 / 2.2)),
                5e-5 * std::min(1.0, std::pow(light, 1 / 2.2)) + 1e-7)
        << light;
  EXPECT_LT(shown_light(0), 1e-4);
  EXPECT_LT(shown_light(-1), 1e-4);
}

TEST(StrokeField, WhatIsPutBackIsAsItWas) {
  StrokeView view = kernel_view(true, 2);
  const StrokeRules r = kernel_rules();
  StrokeField field(view, r);
  const Eigen::Vector2d a(10, 12), b(31, 40), c(12, 44), d(35, 9);
  const double before = field.fall(a, b, 1);
  StrokePixelsBefore log;
  const double fell = field.add(a, b, 1, field.whole(), &log);
  EXPECT_NEAR(fell, before, 1e-6 * std::abs(before));
  field.add(c, d, 1, field.whole(), &log);
  field.add(a, b, -1, field.whole(), &log);
  field.put_back(log);
  const std::vector<float> light = view.light.data;
  field.write_light(view);
  EXPECT_EQ(view.light.data, light);
}

// Slanting and straight ones, through pixels' corners and along their sides, longer than what is worked on in one go,
// and beyond the picture.
const std::vector<std::pair<Eigen::Vector2d, Eigen::Vector2d>> kCourses{
    {{10.1, 12.3}, {31.7, 40.9}}, {{3, 20.4}, {57, 20.4}}, {{20.4, 57}, {20.4, 3}}, {{0.75, 0.75}, {58.5, 58.5}},
    {{58.5, 1.5}, {1.5, 58.5}},   {{15, 30}, {45, 30}},    {{7.5, 50}, {7.5, 11}},  {{33.3, 33.3}, {33.31, 33.3}},
    {{1, 59}, {59, 0.4}},         {{-20, 10}, {30, 25.5}}, {{40, 50}, {75, 90}}};

TEST(StrokeField, TilesTogetherAddWhatTheWholeDoes) {
  const StrokeRules r = kernel_rules();
  StrokeView view = kernel_view(false, 1);
  StrokeField whole(view, r), tiled(view, r);
  const Tiling tiling{32, 9, 21, kSidePixels, kSidePixels};
  for (const auto& [a, b] : kCourses) {
    const double at_once = whole.add(a, b, 1, whole.whole());
    double fell = 0;
    for (std::size_t t = 0; t < tiling.size(); ++t) fell += tiled.add(a, b, 1, tiling.box(t));
    EXPECT_NEAR(fell, at_once, 1e-5 * std::abs(at_once) + 1e-9) << a.transpose() << " to " << b.transpose();
  }
  StrokeView from_tiles = view;
  whole.write_light(view);
  tiled.write_light(from_tiles);
  EXPECT_EQ(view.light.data, from_tiles.light.data);
  EXPECT_EQ(view.asides[0].light.data, from_tiles.asides[0].light.data);
}

TEST(StrokeField, AStrokesPixelsAreAsLongAsItIs) {
  StrokeRules r = kernel_rules();
  r.alpha = 1e4;  // so rough that all directions glint alike
  for (const auto& [a, b] : kCourses) {
    StrokeView view = kernel_view(false, 0);
    std::fill(view.light.data.begin(), view.light.data.end(), 0.0F);
    StrokeField field(view, r);
    field.add(a, b, 1, field.whole());
    field.write_light(view);
    double length = 0;
    for (std::size_t i = 0; i < view.light.data.size(); ++i)
      length += static_cast<double>(view.light.data[i]) / static_cast<double>(view.unit.data[i]);
    // What of it lies on the picture, by thousands of points.
    constexpr int kPoints = 400000;
    int inside = 0;
    for (int k = 0; k < kPoints; ++k) {
      const Eigen::Vector2d p = field.pixel(a + (k + 0.5) / kPoints * (b - a));
      if (field.whole().contains(static_cast<int>(std::floor(p.x())), static_cast<int>(std::floor(p.y())))) ++inside;
    }
    const double wanted = (field.pixel(b) - field.pixel(a)).norm() * inside / kPoints;
    EXPECT_NEAR(length, wanted, 1e-5 * wanted + 1e-5) << a.transpose() << " to " << b.transpose();
  }
}

TEST(MissingLight, PixelsAreDrawnByWhatTheyMiss) {
  std::mt19937 random(5);
  for (const std::size_t pixels : {1U, 2U, 15U, 16U, 17U, 48U, 49U, 100U, 1000U}) {
    MissingLight missing;
    missing.pixels = pixels;
    const std::size_t blocks = (pixels + MissingLight::kBlock - 1) / MissingLight::kBlock;
    missing.of_pixel.assign(blocks * MissingLight::kBlock, 0.0F);
    // Whole numbers, which add up without rounding; many miss nothing.
    for (std::size_t i = 0; i < pixels; ++i)
      missing.of_pixel[i] = random() % 3 == 0 ? static_cast<float>(random() % 8) : 0.0F;
    missing.of_pixel[pixels / 2] = 5;
    double sum = 0;
    for (std::size_t i = 0; i < missing.of_pixel.size(); ++i) {
      sum += static_cast<double>(missing.of_pixel[i]);
      if (i % MissingLight::kBlock == MissingLight::kBlock - 1) missing.upto.push_back(sum);
    }
    std::vector<int> drawn(pixels, 0);
    for (int k = 0; k < static_cast<int>(sum); ++k) ++drawn[missing.pixel_at((k + 0.5) / sum)];
    for (std::size_t i = 0; i < pixels; ++i) EXPECT_EQ(drawn[i], static_cast<int>(missing.of_pixel[i])) << i;
  }
}

TEST(StrokeTiles, CoverEveryPixelOnce) {
  for (const int shift : {0, 5, 15}) {
    const Tiling tiling{16, shift, 7, 50, 35};
    std::vector<int> seen(50 * 35, 0);
    for (std::size_t t = 0; t < tiling.size(); ++t) {
      const PixelBox box = tiling.box(t);
      for (int y = box.y0; y < box.y1; ++y)
        for (int x = box.x0; x < box.x1; ++x) {
          ++seen[static_cast<std::size_t>(y) * 50 + x];
          EXPECT_EQ(tiling.tile_of(x, y), t);
        }
    }
    for (const int n : seen) EXPECT_EQ(n, 1);
  }
}

TEST(StrokeTiles, SharesAddUpAndFollowTheirWeights) {
  const std::vector<double> weights{1, 0, 3, 2, 0, 4};
  for (const double start : {0.0, 0.3, 0.99}) {
    const std::vector<std::size_t> shares = shared_out(1000, weights, start);
    EXPECT_EQ(std::accumulate(shares.begin(), shares.end(), std::size_t{0}), 1000U);
    for (std::size_t i = 0; i < weights.size(); ++i)
      EXPECT_NEAR(static_cast<double>(shares[i]), 100 * weights[i], 1.01) << i;
  }
  EXPECT_EQ(shared_out(5, {0, 0}, 0.5), (std::vector<std::size_t>{0, 0}));
}

}  // namespace
}  // namespace burin
