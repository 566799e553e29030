// Proves that the search's kernel comes to the same bits at every width, that what it says a stroke gains is what the
// error falls by when the stroke is added, that its ends are the best ones among all along the line, and that tiles and
// shares leave nothing out.
#include "burin/optimize/design/stroke_kernel.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <numeric>
#include <random>

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
