// Speed of a rendered view on the fast path, with its correctness beside it: whole pairs per second (found, clipped,
// evaluated, scattered, differentiated) for each width of packets, finding pairs alone, the paper's two workloads
// without their loss, and how time grows with the number of scratches. `pairs/s` counts processor time on one thread
// unless the name says threads; `image_rms` and `gradient_rms` are against the double path on the same scene.
#include <benchmark/benchmark.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>

#include "render/pairs.h"
#include "render/view_renderer.h"

namespace burin {
namespace {

constexpr double kBoard_mm = 300;

/// A view of the paper's board (wt = d = 1e-4 of its edge, alpha 0.04), seen as a picture laid on it.
ViewScene paper_scene(int pixels, int view = 0, int views = 1) {
  ViewScene scene;
  scene.grid = board_grid({0, 0}, {kBoard_mm, kBoard_mm}, pixels, pixels, {{kBoard_mm, kBoard_mm}, {0, 0, 0}});
  const double azimuth = 3.14159265358979 * view / views, r = 900;
  const Eigen::Vector3d middle(kBoard_mm / 2, kBoard_mm / 2, 0);
  scene.camera_center_mm = middle + r * Eigen::Vector3d(std::cos(azimuth), std::sin(azimuth), 1) / std::sqrt(2);
  scene.light.position_mm = middle + r * Eigen::Vector3d(-std::sin(azimuth), std::cos(azimuth), 1) / std::sqrt(2);
  scene.light.intensity = {1e6, 1e6, 1e6};
  scene.material = {0.04, 30, 0.15, {0.91, 0.92, 0.92}};
  scene.tool_width_um = 30;
  return scene;
}

/// Scratches of 2 to 5 % of the board, as designs have them.
Scratches random_scratches(int count) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> where(0.03 * kBoard_mm, 0.97 * kBoard_mm), turn(0, 2 * 3.14159265358979),
      length(0.01 * kBoard_mm, 0.025 * kBoard_mm);
  Scratches s;
  for (int i = 0; i < count; ++i) {
    const double x = where(random), y = where(random), a = turn(random), half = length(random);
    s.x0_mm.push_back(x - half * std::cos(a));
    s.y0_mm.push_back(y - half * std::sin(a));
    s.x1_mm.push_back(x + half * std::cos(a));
    s.y1_mm.push_back(y + half * std::sin(a));
  }
  return s;
}

Image random_weights(const ViewScene& scene) {
  Image weights(scene.grid.width(), scene.grid.height(), 1);
  std::mt19937 random(3);
  for (float& v : weights.data) v = std::uniform_real_distribution<float>(-1, 1)(random);
  return weights;
}

/// Compares one image and the ends' gradients with the double path's.
void report_correctness(benchmark::State& state, const ViewScene& scene, const Scratches& scratches, SimdWidth simd) {
  const Image weights = random_weights(scene);
  Image image[2];
  ScratchGradients g[2];
  for (const bool use_double : {false, true}) {
    RenderOptions options{1, use_double, false, simd};
    ViewRenderer renderer(scene, options);
    renderer.forward_with_jacobian(scratches, image[use_double]);
    g[use_double].resize(scratches.size());
    renderer.backward(weights, g[use_double]);
  }
  double peak = 0, image2 = 0, error2 = 0, size2 = 0;
  for (std::size_t i = 0; i < image[0].data.size(); ++i) {
    peak = std::max<double>(peak, image[1].data[i]);
    image2 += std::pow(static_cast<double>(image[0].data[i]) - image[1].data[i], 2);
  }
  for (std::size_t s = 0; s < scratches.size(); ++s) {
    for (const auto member :
         {&ScratchGradients::x0_mm, &ScratchGradients::y0_mm, &ScratchGradients::x1_mm, &ScratchGradients::y1_mm}) {
      error2 += std::pow((g[0].*member)[s] - (g[1].*member)[s], 2);
      size2 += std::pow((g[1].*member)[s], 2);
    }
  }
  state.counters["image_rms"] = std::sqrt(image2 / image[0].data.size()) / peak;
  state.counters["gradient_rms"] = std::sqrt(error2 / size2);
}

void one_iteration(ViewRenderer& renderer, const Scratches& scratches, const Image& weights, Image& image,
                   ScratchGradients& gradients) {
  renderer.forward_with_jacobian(scratches, image);
  gradients.resize(scratches.size());
  renderer.backward(weights, gradients);
}

void WholePairs(benchmark::State& state) {
  const auto simd = static_cast<SimdWidth>(state.range(0));
  if (!has_kernel(simd)) {
    state.SkipWithError("this machine has no such packets");
    return;
  }
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const ViewScene scene = paper_scene(512);
  const Scratches scratches = random_scratches(80000);
  const Image weights = random_weights(scene);
  RenderOptions options;
  options.material_gradients = state.range(1) != 0;
  options.simd = simd;
  ViewRenderer renderer(scene, options);
  Image image;
  ScratchGradients gradients;
  for (auto _ : state) one_iteration(renderer, scratches, weights, image, gradients);
  state.counters["pairs"] = static_cast<double>(renderer.pair_count());
  state.counters["pairs/s"] =
      benchmark::Counter(static_cast<double>(renderer.pair_count() * state.iterations()), benchmark::Counter::kIsRate);
  state.SetLabel(std::to_string(kernel_lanes(simd)) + " lanes" + (state.range(1) != 0 ? ", wt, d and alpha too" : ""));
  report_correctness(state, scene, scratches, simd);
}
BENCHMARK(WholePairs)
    ->ArgsProduct({{static_cast<int>(SimdWidth::generic), static_cast<int>(SimdWidth::avx2),
                    static_cast<int>(SimdWidth::avx512)},
                   {0, 1}})
    ->Unit(benchmark::kMillisecond);

void ForwardOnly(benchmark::State& state) {
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const Scratches scratches = random_scratches(80000);
  ViewRenderer renderer(paper_scene(512));
  Image image;
  for (auto _ : state) renderer.forward(scratches, image);
  state.counters["pairs/s"] =
      benchmark::Counter(static_cast<double>(renderer.pair_count() * state.iterations()), benchmark::Counter::kIsRate);
}
BENCHMARK(ForwardOnly)->Unit(benchmark::kMillisecond);

void FindPairs(benchmark::State& state) {
  const ViewScene scene = paper_scene(512);
  const PixelIndex index(scene.grid);
  const auto strips = strips_of(random_scratches(80000), scene.tool_width_um, scene.material.depth_um);
  std::vector<PixelSpan> spans;
  std::size_t pairs = 0;
  for (auto _ : state) {
    spans.clear();
    for (const Strip& strip : strips) index.find(strip, spans);
    benchmark::DoNotOptimize(spans.data());
  }
  for (const PixelSpan& s : spans) pairs += s.end - s.begin;
  state.counters["per_pair"] = benchmark::Counter(static_cast<double>(pairs) * static_cast<double>(state.iterations()),
                                                  benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}
BENCHMARK(FindPairs)->Unit(benchmark::kMillisecond);

/// One iteration of a design over all of its views: forward with Jacobian and backward, all threads.
void PaperWorkload(benchmark::State& state) {
  const int count = static_cast<int>(state.range(0)), views = static_cast<int>(state.range(1));
  const auto threads = static_cast<std::size_t>(state.range(2));
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
  const Scratches scratches = random_scratches(count);
  RenderOptions options;
  options.material_gradients = false;
  std::vector<ViewRenderer> renderers;
  for (int v = 0; v < views; ++v) renderers.emplace_back(paper_scene(512, v, views), options);
  const Image weights = random_weights(renderers[0].scene());
  Image image;
  ScratchGradients gradients;
  std::size_t pairs = 0;
  for (auto _ : state)
    for (ViewRenderer& renderer : renderers) one_iteration(renderer, scratches, weights, image, gradients);
  for (const ViewRenderer& renderer : renderers) pairs += renderer.pair_count();
  state.counters["pairs"] = static_cast<double>(pairs);
  state.counters["s/100"] = benchmark::Counter(static_cast<double>(state.iterations()) / 100,
                                               benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
  state.SetLabel("without loss and Adam, " + std::to_string(threads) + " threads");
}
BENCHMARK(PaperWorkload)
    ->Args({40000, 2, 1})
    ->Args({40000, 2, 2})
    ->Args({80000, 5, 1})
    ->Args({80000, 5, 2})
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

/// Time per pair as scratches grow in number.
void Scaling(benchmark::State& state) {
  const int count = static_cast<int>(state.range(0));
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const ViewScene scene = paper_scene(512);
  const Scratches scratches = random_scratches(count);
  const Image weights = random_weights(scene);
  RenderOptions options;
  options.material_gradients = false;
  ViewRenderer renderer(scene, options);
  Image image;
  ScratchGradients gradients;
  for (auto _ : state) one_iteration(renderer, scratches, weights, image, gradients);
  state.counters["per_pair"] =
      benchmark::Counter(static_cast<double>(renderer.pair_count()) * static_cast<double>(state.iterations()),
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}
BENCHMARK(Scaling)->RangeMultiplier(10)->Range(10000, 1000000)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace burin
