// Speed of what a design does in an iteration besides rendering: gamma curve, picture loss with and without the Gram
// term, chain rule back to radiance, for one view of 512 x 512 pixels; and Adam over both ends of 80,000 scratches. One
// thread. `allocations`: calls of malloc and its like each time. That their gradients
// are right: tests/optimize/loss_test, adam_test.
#include <benchmark/benchmark.h>
#include <tbb/global_control.h>

#include <random>
#include <vector>

#include "burin/optimize/loss/adam.h"
#include "burin/optimize/loss/loss.h"
#include "tests/allocations.h"

namespace burin {
namespace {

constexpr int kPixels = 512;

Image noise(unsigned seed) {
  std::mt19937 random(seed);
  Image image(kPixels, kPixels, 1);
  for (float& v : image.data) v = std::uniform_real_distribution<float>(0, 1)(random);
  return image;
}

/// Times `work` on one thread, after a first time that may fill buffers.
template <typename Work>
void time_steady(benchmark::State& state, const Work& work) {
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  work();
  const std::size_t before = allocations();
  for (auto _ : state) work();
  state.counters["allocations"] = static_cast<double>(allocations() - before) / static_cast<double>(state.iterations());
}

void GammaCurve(benchmark::State& state) {
  const Image radiance = noise(1);
  Image picture;
  time_steady(state, [&] { picture_from_radiance(radiance, 1.3, picture); });
}
BENCHMARK(GammaCurve)->Unit(benchmark::kMillisecond);

void GammaGradient(benchmark::State& state) {
  const Image radiance = noise(1), dE_dpicture = noise(2);
  Image picture, dE_dradiance;
  picture_from_radiance(radiance, 1.3, picture);
  time_steady(state,
              [&] { benchmark::DoNotOptimize(radiance_gradient(radiance, 1.3, picture, dE_dpicture, dE_dradiance)); });
}
BENCHMARK(GammaGradient)->Unit(benchmark::kMillisecond);

void Loss(benchmark::State& state, const LossWeights& weights, bool masked) {
  PictureLoss loss(noise(1), masked ? noise(3) : Image{}, weights);
  const Image picture = noise(2);
  Image gradient;
  time_steady(state, [&] { benchmark::DoNotOptimize(loss.evaluate(picture, gradient)); });
}
BENCHMARK_CAPTURE(Loss, perceptual, LossWeights{1, 0, 0}, false)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Loss, l2, LossWeights{0, 1, 0}, false)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Loss, gram, LossWeights{0, 0, 0.01}, false)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Loss, all, LossWeights{1, 0.1, 0.01}, false)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Loss, all_masked, LossWeights{1, 0.1, 0.01}, true)->Unit(benchmark::kMillisecond);

void AdamStep(benchmark::State& state) {
  std::mt19937 random(1);
  std::vector<double> parameters(320000), gradient(parameters.size());
  for (double& g : gradient) g = std::uniform_real_distribution<double>(-1, 1)(random);
  Adam adam(parameters.size());
  time_steady(state, [&] { adam.step(parameters, gradient, 1e-3); });
}
BENCHMARK(AdamStep)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace burin
