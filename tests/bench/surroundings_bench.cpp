// Surroundings, and a lamp with an area, against a point lamp, one view of 512 x 512 pixels on one thread: a room with
// a window, walls and a ceiling, on a board of Burin's (120 mm, wt 400 um, d 14 um, alpha 0.06) and on the paper's (300
// mm, wt and d 30 um, alpha 0.04). Forward alone, and with the way back to both ends. `tables_ms`: what is made once a
// view, before the first picture. `image_rms`, `gradient_rms`: against the double twin, over the image's peak and the
// gradient's RMS.
#include <benchmark/benchmark.h>
#include <tbb/global_control.h>

#include <chrono>
#include <cmath>
#include <map>
#include <numbers>
#include <random>

#include "burin/render/view_renderer.h"
#include "burin/scene/far_light.h"
#include "tests/bench/paper_scene.h"

namespace burin {
namespace {

// Walls of 0.3, a ceiling of 0.5, a floor of 0.1, and a window of 30 in the direction that the lamp had.
Light room() {
  Image picture(256, 128, 3, 0.3F);
  const auto panorama = make_panorama(picture, {}, "room");
  const Eigen::Vector3d window = Eigen::Vector3d(0, 0.6, 0.8).normalized();
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      const Eigen::Vector3d to = panorama->direction(x + 0.5, y + 0.5);
      float value = to.y() > 0.6 ? 0.5F : to.y() < -0.6 ? 0.1F : 0.3F;
      if (to.dot(window) > std::cos(8 * std::numbers::pi / 180)) value = 30;
      for (int c = 0; c < 3; ++c) picture.at(x, y, c) = value;
    }
  return surroundings_light(make_panorama(picture, {}, "room"));
}

struct Bench {
  ViewScene scene;
  Carved carved;
};

Bench burins(int count) {
  constexpr double kBoard = 120;
  Bench out;
  out.scene.grid = share(board_grid({0, 0}, {kBoard, kBoard}, 512, 512, {{kBoard, kBoard}, {0, 0, 0}}));
  out.scene.camera_center_mm = {60, -240, 560};
  out.scene.light.position_mm = {60, 490, 560};
  out.scene.light.intensity = {1e6, 1e6, 1e6};
  out.scene.material.alpha = 0.06;
  out.scene.material.depth_um = 14;
  std::mt19937 random(7);
  std::uniform_real_distribution<double> where(0, kBoard), turn(0, std::numbers::pi), half(1, 4);
  Scratches& s = out.carved.scratches;
  for (int i = 0; i < count; ++i) {
    const double x = where(random), y = where(random), a = turn(random), h = half(random);
    s.x0_mm.push_back(x - h * std::cos(a));
    s.y0_mm.push_back(y - h * std::sin(a));
    s.x1_mm.push_back(x + h * std::cos(a));
    s.y1_mm.push_back(y + h * std::sin(a));
  }
  return out;
}

Bench papers(int count) { return {paper_scene(paper_grid(512)), in_metal(paper_scratches(count))}; }

void report_twin(benchmark::State& state, const Bench& bench, const Image& weights) {
  Image image[2];
  ScratchGradients g[2];
  for (const bool twin : {false, true}) {
    ViewRenderer renderer(bench.scene, {1, twin, false});
    renderer.forward_with_jacobian(bench.carved, image[twin]);
    renderer.backward(weights, g[twin]);
  }
  report_differences(state, image, g);
}

enum Kind { kPoint, kRoom, kDisk };

void time_light(benchmark::State& state, Bench bench, Kind kind, bool back) {
  using Clock = std::chrono::steady_clock;
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const bool around = kind == kRoom;
  if (around) bench.scene.light = room();
  if (kind == kDisk) {
    bench.scene.light.size.disk_mm = 25;
    bench.scene.light.axis = -bench.scene.light.position_mm.normalized();
  }
  const Image weights = random_weights(512, 512);
  const auto start = Clock::now();
  ViewRenderer renderer(bench.scene, {1, false, false}, make_render_workspace());  // as in a design
  Image image;
  ScratchGradients gradients;
  double nudge_mm = 1e-6;
  const auto once = [&] {
    bench.carved.scratches.x0_mm[0] += nudge_mm;  // scratches that lie where they lay would be found once
    nudge_mm = -nudge_mm;
    if (!back) {
      renderer.forward(bench.carved, image);
      return;
    }
    renderer.forward_with_jacobian(bench.carved, image);
    gradients.resize(bench.carved.size());
    renderer.backward(weights, gradients);
  };
  once();
  if (around) state.counters["tables_ms"] = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
  for (auto _ : state) once();
  const auto pairs = static_cast<double>(renderer.pair_count());
  state.counters["pairs"] = pairs;
  state.counters["ns/pair"] = benchmark::Counter(1e-9 * pairs * static_cast<double>(state.iterations()),
                                                 benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
  if (around && back && bench.carved.size() <= 4000) report_twin(state, bench, weights);
}

void LightOfARoom(benchmark::State& state) {
  const int count = static_cast<int>(state.range(1));
  const auto kind = static_cast<Kind>(state.range(2));
  state.SetLabel(kind == kPoint ? "point lamp" : kind == kRoom ? "surroundings" : "disk lamp of 25 mm");
  time_light(state, state.range(0) != 0 ? papers(count) : burins(count), kind, state.range(3) != 0);
}
BENCHMARK(LightOfARoom)
    ->ArgNames({"papers", "scratches", "light", "back"})
    ->ArgsProduct({{0}, {4000, 40000}, {kPoint, kRoom, kDisk}, {0, 1}})
    ->Unit(benchmark::kMillisecond);
BENCHMARK(LightOfARoom)  // whose tables take their time
    ->ArgNames({"papers", "scratches", "light", "back"})
    ->ArgsProduct({{1}, {80000}, {kPoint, kRoom}, {1}})
    ->Unit(benchmark::kMillisecond)
    ->Iterations(3);

}  // namespace
}  // namespace burin
