// The renderer over scenes drawn at random: the fast path is the double path for every width of packets, threads change
// no bit, and whatever a bench holds - broken numbers, absurd places, extreme grooves - gives a finite picture and
// gradient or an error that names the culprit. That the double path is right: view_renderer_test, rig_prediction_test.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include "burin/base/error.h"
#include "tests/render/expect_fast_is_exact.h"
#include "tests/render/small_world.h"
#include "tests/render/workshop.h"

namespace burin {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

const std::vector<SimdWidth> kWidths{SimdWidth::generic, SimdWidth::avx2, SimdWidth::avx512};

TEST(RandomScenes, FastPathIsTheDoublePathForEveryWidth) {
  // After the first ones, those of many that are hardest: one scratch outshines all others, in pixels much
  // larger than the groove, and a pixel's edge runs along it through its peak, where every rounding of that edge shows.
  std::vector<unsigned> seeds(60);
  std::iota(seeds.begin(), seeds.end(), 0);
  seeds.insert(seeds.end(), {62, 88, 89, 94, 120, 153, 160, 258, 342, 814, 1017, 1947});
  for (const unsigned seed : seeds) {
    const World w = workshop(seed, 150);
    for (const SimdWidth simd : kWidths) {
      if (!has_kernel(simd)) continue;
      expect_fast_is_exact(w, seed % 2 == 0 ? 1 : 3, simd,
                           "seed " + std::to_string(seed) + ", " + std::to_string(kernel_lanes(simd)) + " lanes");
    }
  }
}

TEST(RandomScenes, SameBitsForAnyNumberOfThreads) {
  struct Bits {
    Image image;
    ScratchGradients g;
    std::vector<double> sent;
    std::vector<Image> d_radiance;
  };
  for (const unsigned seed : {1U, 2U, 3U, 4U}) {
    const World w = seed == 1 ? small_world(700) : workshop(seed, 1500);  // several chunks and tiles
    const Image weights = random_weights(w, 1, 4);
    for (const bool use_double : {false, true}) {
      for (const SimdWidth simd : kWidths) {
        if (!has_kernel(simd) || (use_double && simd != SimdWidth::generic)) continue;
        std::vector<Bits> runs;
        for (const int threads : {1, 2, 5}) {
          const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
          ViewRenderer renderer(w.scene, {1, use_double, true, simd});
          Bits& b = runs.emplace_back();
          // Twice: what the first run leaves in the buffers must not matter.
          for (int k = 0; k < 2; ++k) {
            renderer.forward_with_jacobian(in_metal(w.scratches), b.image);
            b.g.resize(w.scratches.size());
            renderer.backward(weights, b.g);
          }
          b.sent.assign(w.scratches.size(), 0);
          renderer.add_contributions(b.sent);
          if (seed == 1)
            b.d_radiance =
                render_with_derivatives(w.scene, w.camera, in_metal(w.scratches), all_parameters()).d_radiance;
          const std::string what = "seed " + std::to_string(seed) + ", " + std::to_string(threads) + " threads, " +
                                   (use_double ? "double" : std::to_string(kernel_lanes(simd)) + " lanes");
          const Bits& first = runs.front();
          EXPECT_EQ(b.image.data, first.image.data) << what;
          EXPECT_EQ(b.sent, first.sent) << what;
          for (const auto member :
               {&ScratchGradients::x0_mm, &ScratchGradients::y0_mm, &ScratchGradients::x1_mm, &ScratchGradients::y1_mm,
                &ScratchGradients::width_um, &ScratchGradients::depth_um, &ScratchGradients::alpha})
            EXPECT_EQ(b.g.*member, first.g.*member) << what;
          for (const auto member : {&ScratchGradients::shared_width_um, &ScratchGradients::shared_depth_um,
                                    &ScratchGradients::shared_alpha, &ScratchGradients::shared_base_alpha})
            EXPECT_EQ(b.g.*member, first.g.*member) << what;
          for (std::size_t k = 0; k < b.d_radiance.size(); ++k)
            EXPECT_EQ(b.d_radiance[k].data, first.d_radiance[k].data) << what;
        }
      }
    }
  }
}

/// Renders and differentiates with every kind of renderer; picture and gradients must be finite, the picture not
/// negative.
void expect_finite(const World& w, int channels, unsigned seed, const std::string& what) {
  const Image weights = random_weights(w, channels, seed);
  for (int kind = -1; kind < static_cast<int>(kWidths.size()); ++kind) {
    const SimdWidth simd = kind < 0 ? SimdWidth::best : kWidths[kind];
    if (!has_kernel(simd)) continue;
    const std::string how = what + (kind < 0 ? ", double" : ", " + std::to_string(kernel_lanes(simd)) + " lanes");
    ViewRenderer renderer(w.scene, {channels, kind < 0, true, simd});
    Image image;
    ScratchGradients g;
    std::vector<double> sent(w.scratches.size(), 0);
    g.resize(w.scratches.size());
    renderer.forward(in_metal(w.scratches), image);
    for (const float v : image.data) ASSERT_TRUE(std::isfinite(v) && v >= 0) << how << ": " << v;
    renderer.forward_with_jacobian(in_metal(w.scratches), image);
    renderer.backward(weights, g);
    renderer.add_contributions(sent);
    for (const float v : image.data) ASSERT_TRUE(std::isfinite(v) && v >= 0) << how << ": " << v;
    for (const auto* values : {&g.x0_mm, &g.y0_mm, &g.x1_mm, &g.y1_mm, &g.width_um, &g.depth_um, &g.alpha,
                               static_cast<std::vector<double>*>(&sent)})
      for (const double v : *values) ASSERT_TRUE(std::isfinite(v)) << how;
    for (const double v : {g.shared_width_um, g.shared_depth_um, g.shared_alpha, g.shared_base_alpha})
      ASSERT_TRUE(std::isfinite(v)) << how;
  }
}

TEST(RandomScenes, AbsurdBenchesGiveNoNaN) {
  // Grazing and inverted cameras, lamps on and behind the face and inside it, mirror-like and rough grooves, grooves
  // wider than the board, scratches without length, as thin as rounding, longer than the world, or far off.
  for (unsigned round = 0; round < 150; ++round) {
    Draw draw{std::mt19937(1000 + round)};
    World w = small_world(30);
    Light& lamp = w.bench.lights[0];
    lamp.position_mm = {draw.uniform(-30, 50), draw.uniform(-30, 50), round % 7 == 0 ? 0 : draw.uniform(-5, 60)};
    if (round % 11 == 0) lamp.position_mm = {10, 10, 1e-9};
    lamp.falloff_exponent = round % 3 == 0 ? 0 : draw.decades(-1, 2);
    w.bench.material.alpha = draw.decades(-3.4, 0);
    w.bench.material.base_alpha = draw.decades(-3, 0);
    w.bench.bow_mm = {draw.uniform(-1, 1), draw.uniform(-1, 1), draw.uniform(-1, 1)};
    w.camera.surface.bow_mm = w.bench.bow_mm;
    w.camera.T_camera_board = looking_at({draw.uniform(-20, 40), draw.uniform(-20, 40), draw.uniform(-3, 60)},
                                         {draw.uniform(0, 20), draw.uniform(0, 20), 0});
    for (std::size_t s = 0; s < w.scratches.size(); ++s) {
      w.scratches.alpha[s] = draw.decades(-3.4, 0);
      w.scratches.width_um[s] = draw.decades(-1, 5);
      w.scratches.depth_um[s] = w.scratches.width_um[s] * draw.decades(-5, 0.4);
      const double length = s % 5 == 0 ? draw.decades(-12, -3) : draw.decades(-2, 1.5);
      w.scratches.x1_mm[s] = w.scratches.x0_mm[s] + (s % 10 == 0 ? 0 : length);
      if (s % 3 == 0) w.scratches.y1_mm[s] = w.scratches.y0_mm[s];
      if (s % 13 == 0) w.scratches.x1_mm[s] = draw.decades(2, 9);
      if (s % 17 == 0) w.scratches.y0_mm[s] = w.scratches.y1_mm[s] = -draw.decades(2, 9);
    }
    w.scene = make_scene(w.bench, w.board, w.camera, lamp);
    const std::string what = "round " + std::to_string(round);
    expect_finite(w, round % 2 == 0 ? 3 : 1, round, what);
    const auto d = render_with_derivatives(w.scene, w.camera, in_metal(w.scratches), all_parameters());
    for (const Image& image : d.d_radiance)
      for (const float v : image.data) ASSERT_TRUE(std::isfinite(v)) << what;
  }
}

TEST(RandomScenes, BrokenFootprintsAreDark) {
  // Corners that are NaN, infinite, or fall together (zero area), centers and normals that are NaN: the pixels that
  // hold them are 0, their neighbors as before.
  for (unsigned round = 0; round < 40; ++round) {
    Draw draw{std::mt19937(round)};
    World w = small_world(60);
    ViewRenderer whole(w.scene);
    Image before, after;
    whole.forward(in_metal(w.scratches), before);
    const int width = w.scene.grid->width(), height = w.scene.grid->height(), stride = width + 1;
    FootprintGrid grid = *w.scene.grid;
    std::vector<bool> broken(static_cast<std::size_t>(width) * height, false);
    for (int k = 0; k < 12; ++k) {
      const int c = static_cast<int>(draw.uniform(0, width)), r = static_cast<int>(draw.uniform(0, height));
      const std::size_t pixel = static_cast<std::size_t>(r) * width + c;
      const std::size_t corner = static_cast<std::size_t>(r) * stride + c;
      if (k % 4 == 3) {
        (round % 2 == 0 ? grid.center_mm : grid.normal)[pixel].y() = kNaN;
        broken[pixel] = true;
        continue;
      }
      grid.corner_x_mm[corner] = k % 4 == 0 ? kNaN : k % 4 == 1 ? kInfinity : -kInfinity;
      for (int y = std::max(0, r - 1); y <= r; ++y)
        for (int x = std::max(0, c - 1); x <= c; ++x) broken[static_cast<std::size_t>(y) * width + x] = true;
    }
    w.scene.grid = share(grid);
    expect_finite(w, 1, round, "round " + std::to_string(round));
    for (const bool use_double : {false, true}) {
      ViewRenderer renderer(w.scene, {1, use_double});
      renderer.forward(in_metal(w.scratches), after);
      for (std::size_t i = 0; i < broken.size(); ++i) {
        const double expected = broken[i] ? 0 : before.data[i];
        EXPECT_NEAR(after.data[i], expected, 1e-5 * expected) << "round " << round << ", pixel " << i;
      }
    }
    // All corners of a picture in one place, or on one line: no footprint has an area.
    for (double& x : grid.corner_x_mm) x = 7;
    if (round % 2 == 0)
      for (double& y : grid.corner_y_mm) y = 5;
    grid.board_from_pixel.reset();
    w.scene.grid = share(grid);
    expect_finite(w, 1, round, "without area");
    ViewRenderer(w.scene).forward(in_metal(w.scratches), after);
    for (const float v : after.data) EXPECT_EQ(v, 0);
  }
}

/// What an Error says, or "nothing".
std::string message_of(const std::function<void()>& act) {
  try {
    act();
  } catch (const Error& e) {
    return e.what();
  }
  return "nothing";
}

TEST(RandomScenes, BrokenScratchesAreNamed) {
  Draw draw{std::mt19937(5)};
  const std::vector<std::pair<std::vector<double> Scratches::*, std::string>> members{
      {&Scratches::x0_mm, "x0_mm"}, {&Scratches::y0_mm, "y0_mm"},       {&Scratches::x1_mm, "x1_mm"},
      {&Scratches::y1_mm, "y1_mm"}, {&Scratches::width_um, "width_um"}, {&Scratches::depth_um, "depth_um"},
      {&Scratches::alpha, "alpha"}};
  const World w = small_world(300);
  for (const bool use_double : {false, true}) {
    ViewRenderer renderer(w.scene, {1, use_double});
    Image image, good;
    renderer.forward(in_metal(w.scratches), good);
    for (const auto& [member, name] : members) {
      const bool positive = name == "width_um" || name == "depth_um" || name == "alpha";
      std::vector<double> values{kNaN, kInfinity, -kInfinity};
      if (positive) values.insert(values.end(), {0.0, -1.0});
      for (const double value : values) {
        Scratches broken = w.scratches;
        const auto s = static_cast<std::size_t>(draw.uniform(0, 300));
        (broken.*member)[s] = value;
        const std::string culprit = name + " of scratch " + std::to_string(s);
        EXPECT_THAT(message_of([&] { renderer.forward(in_metal(broken), image); }), testing::HasSubstr(culprit));
        EXPECT_THAT(message_of([&] { renderer.forward_with_jacobian(in_metal(broken), image); }),
                    testing::HasSubstr(culprit));
        EXPECT_THAT(message_of([&] { render_with_derivatives(w.scene, w.camera, in_metal(broken), all_parameters()); }),
                    testing::HasSubstr(culprit));
      }
      Scratches short_of_one = w.scratches;
      (short_of_one.*member).pop_back();
      EXPECT_NE(message_of([&] { renderer.forward(in_metal(short_of_one), image); }), "nothing") << name;
    }
    // And the renderer still works.
    renderer.forward(in_metal(w.scratches), image);
    EXPECT_EQ(image.data, good.data);
  }
}

TEST(RandomScenes, BrokenSceneValuesAreNamed) {
  struct Field {
    std::string name;
    std::function<double&(ViewScene&)> value;
    std::vector<double> wrong;
  };
  const std::vector<double> never{kNaN, kInfinity, -kInfinity}, not_positive{kNaN, kInfinity, 0, -1};
  const std::vector<Field> fields{
      {"light.position_mm", [](ViewScene& s) -> double& { return s.light.position_mm.y(); }, never},
      {"light.intensity", [](ViewScene& s) -> double& { return s.light.intensity[2]; }, never},
      {"light.axis", [](ViewScene& s) -> double& { return s.light.axis.x(); }, never},
      {"light.falloff_exponent",
       [](ViewScene& s) -> double& { return s.light.falloff_exponent; },
       {kNaN, kInfinity, -1}},
      {"material.alpha", [](ViewScene& s) -> double& { return s.material.alpha; }, not_positive},
      {"material.depth_um", [](ViewScene& s) -> double& { return s.material.depth_um; }, not_positive},
      {"material.base_alpha", [](ViewScene& s) -> double& { return s.material.base_alpha; }, not_positive},
      {"material.f0", [](ViewScene& s) -> double& { return s.material.f0[1]; }, never},
      {"tool_width_um", [](ViewScene& s) -> double& { return s.tool_width_um; }, not_positive},
      {"ambient", [](ViewScene& s) -> double& { return s.ambient[0]; }, never},
      {"camera_center_mm", [](ViewScene& s) -> double& { return s.camera_center_mm.z(); }, never}};
  const World w = small_world(3);
  for (const Field& field : fields)
    for (const double wrong : field.wrong)
      for (const bool use_double : {false, true}) {
        ViewScene scene = w.scene;
        field.value(scene) = wrong;
        const std::string message = message_of([&] { ViewRenderer r(scene, {1, use_double}); });
        EXPECT_THAT(message, testing::HasSubstr(field.name)) << wrong;
      }
}

TEST(RandomScenes, DarkWhereNothingCanBeSeenOrLit) {
  // Lamps behind the board leave the room's light; cameras below the horizon leave nothing; no gradient in either.
  for (unsigned round = 0; round < 40; ++round) {
    Draw draw{std::mt19937(round)};
    World w = small_world(60);
    const bool lamp = round % 2 == 0;
    const Eigen::Vector3d behind(draw.uniform(-40, 60), draw.uniform(-40, 60), -draw.decades(-6, 3));
    (lamp ? w.scene.light.position_mm : w.scene.camera_center_mm) = behind;
    w.scene.grid = share(board_grid({0, 0}, {20, 20}, 24, 18, {w.board.size_mm, {0, 0, 0}}));
    const double room = w.scene.ambient.cwiseProduct(w.scene.material.f0).mean();
    for (const bool use_double : {false, true}) {
      ViewRenderer renderer(w.scene, {1, use_double});
      Image image;
      ScratchGradients g;
      g.resize(w.scratches.size());
      renderer.forward_with_jacobian(in_metal(w.scratches), image);
      renderer.backward(random_weights(w, 1, round), g);
      for (const float v : image.data) EXPECT_EQ(v, lamp ? static_cast<float>(room) : 0.0F) << "round " << round;
      for (const auto* values : {&g.x0_mm, &g.y0_mm, &g.x1_mm, &g.y1_mm, &g.width_um, &g.depth_um, &g.alpha})
        EXPECT_THAT(*values, testing::Each(0.0)) << "round " << round;
    }
  }
}

}  // namespace
}  // namespace burin
