// Proves, by photographs of the point sampler: the renderer's closed forms see a brushed face, a rounded V with burrs
// and a machine's backlash as the sampler's points do, which share none of their formulas; and what a truth cannot be
// is named.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "burin/base/cell_grid.h"
#include "burin/base/error.h"
#include "burin/render/view_renderer.h"
#include "burin/simulate/bench_truth.h"
#include "burin/simulate/point_sampler.h"
#include "tests/capture/small_truth.h"

namespace burin {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

// The share of light by which the renderer's view differs from the sampler's, over the pixels of the carve area.
double difference(const Json& json, double scale) {
  TemporaryFolder folder;
  const BenchTruth truth = read_bench_truth(write_truth(folder, json));
  const Carved carved = carved_by(truth, sent_scratches(truth));
  const Image sampled = PointSampler(truth, carved).radiance(truth.views[0], truth.lights[0]);
  Bench bench;
  bench.lens = truth.lens;
  bench.material = truth.board.material;
  const CameraView camera{truth.lens, truth.views[0].T_camera_board, truth.surface, {0, 0, 320, 240}};
  ViewScene scene = make_scene(bench, truth.board, camera, truth.lights[0]);
  Image rendered;
  ViewRenderer(scene, {3}).forward(carved, rendered);
  double error2 = 0, size2 = 0, mean_rendered = 0, mean_sampled = 0;
  for (int y = 90; y < 150; ++y)
    for (int x = 120; x < 200; ++x) {
      const double a = rendered.at(x, y, 1), b = sampled.at(x, y, 1);
      error2 += (a - b) * (a - b);
      size2 += b * b;
      mean_rendered += a;
      mean_sampled += b;
    }
  EXPECT_NEAR(mean_rendered / mean_sampled, 1, scale);
  return std::sqrt(error2 / size2);
}

Json finely_sampled() {
  Json json = small_truth();
  json["samples"] = 1024;
  json["samples_plain"] = 64;
  // The lamp where some grooves and the face glint.
  json["lights"][0]["position_mm"] = {150, 60, 450};
  return json;
}

TEST(MetalTruth, ABrushedFaceIsSeenAlike) {
  Json json = finely_sampled();
  json["material"]["brushed"] = {{"along_deg", 30}, {"alpha_along", 0.1}, {"alpha_across", 0.3}};
  json["scratches"]["random"]["count"] = 1;
  EXPECT_LT(difference(json, 1e-3), 3e-3);
}

TEST(MetalTruth, ARoundedVWithBurrsIsSeenAlike) {
  Json json = finely_sampled();
  json["material"]["profile"] = {{"kind", "rounded-v"},
                                 {"flank_deg", 18},
                                 {"burr_height_um", {1.5, 0.8}},
                                 {"burr_width_um", 12},
                                 {"alpha_across", 1.3}};
  json["overlap"] = "sum";
  // 1024 points of a pixel of half a millimeter: some hundred of them on a groove of 0.1 mm, 5 % of its light each.
  EXPECT_LT(difference(json, 5e-3), 0.05);
}

TEST(MetalTruth, BacklashAndScrewsMoveGroovesAsCarveSays) {
  Json json = small_truth();
  json["machine"] = {{"affine", {{1, 0, 0.1}, {0, 1, -0.05}}},
                     {"backlash_mm", {0.06, 0.1}},
                     {"screw_mm", {0.02, 0.015}},
                     {"screw_period_mm", {5, 8}},
                     {"screw_phase_deg", {30, 200}}};
  TemporaryFolder folder;
  const BenchTruth truth = read_bench_truth(write_truth(folder, json));
  const Sent sent = sent_scratches(truth);
  const Carved by_truth = carved_by(truth, sent);
  Bench bench;
  bench.machine_affine = truth.machine_affine;
  bench.machine_errors = truth.machine_errors;
  const Carved by_carve = carve(sent, bench, truth.believed);
  // Both are chains of pieces of different lengths: every joint of one lies on the other, but for the sagitta of a
  // piece.
  double most = 0;
  for (std::size_t i = 0; i < by_carve.size(); ++i) {
    const Eigen::Vector2d p(by_carve.scratches.x0_mm[i], by_carve.scratches.y0_mm[i]);
    double nearest = 1e9;
    for (std::size_t k = 0; k < by_truth.size(); ++k) {
      const Eigen::Vector2d a(by_truth.scratches.x0_mm[k], by_truth.scratches.y0_mm[k]),
          b(by_truth.scratches.x1_mm[k], by_truth.scratches.y1_mm[k]);
      const double at = std::clamp((p - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
      nearest = std::min(nearest, (a + at * (b - a) - p).norm());
    }
    most = std::max(most, nearest);
  }
  EXPECT_LT(most, 3e-3);
}

TEST(MetalTruth, WhatCannotBeIsNamed) {
  TemporaryFolder folder;
  Json json = small_truth();
  json["material"]["profile"] = {{"kind", "rounded-v"}, {"flank_deg", 24}, {"burr_height_um", {20, 1}}};
  EXPECT_THAT([&] { read_bench_truth(write_truth(folder, json)); },
              ThrowsMessage<Error>(HasSubstr("burrs stand lower than their groove is deep")));
  json["material"]["profile"] = {{"kind", "rounded-v"}, {"flank_deg", 95}};
  EXPECT_THAT([&] { read_bench_truth(write_truth(folder, json)); }, ThrowsMessage<Error>(HasSubstr("up to 75")));
  json["material"]["profile"] = {{"kind", "u"}};
  EXPECT_THAT([&] { read_bench_truth(write_truth(folder, json)); }, ThrowsMessage<Error>(HasSubstr("rounded-v")));
  json = small_truth();
  json["board"]["size_mm"] = {1e9, 80};
  EXPECT_THAT([&] { read_bench_truth(write_truth(folder, json)); }, ThrowsMessage<Error>(HasSubstr("at most 100,000")));
}

TEST(MetalTruth, ALargeBoardTakesNoMoreMemoryThanItsScratches) {
  const CellGrid usual = cell_grid({120, 80.5}, 1), long_strip = cell_grid({1e5, 2}, 1),
                 largest = cell_grid({1e5, 1e5}, 1);
  EXPECT_EQ(usual.cell_mm, 1);
  EXPECT_EQ(usual.cells(), 120U * 81U);
  EXPECT_EQ(long_strip.cells(), 200'000U);
  EXPECT_LT(largest.cells(), 4'100'000U);
  EXPECT_EQ(largest.column(1e5), largest.columns - 1);
  EXPECT_EQ(largest.row(-1e300), 0);
}

}  // namespace
}  // namespace burin
