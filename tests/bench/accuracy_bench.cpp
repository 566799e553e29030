// How far the fast path is from the double path over 300 benches drawn at random (tests/render/workshop.h): boards of
// 20 to 400 mm, tools of 25 to 800 um, shallow and deep grooves, pixels smaller and larger than they, alpha 0.02 to
// 0.3, 150 scratches each. `image_worst`, `image_median`: RMS of the image's error over its peak; `gradient_...`: the
// largest relative RMS error among both ends, width, depth and alpha. `within`: the share of the benches in which the
// image is within 1e-6 and every gradient within 1e-4.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <string>
#include <vector>

#include "tests/render/workshop.h"

namespace burin {
namespace {

constexpr unsigned kBenches = 300;

void FastPathAccuracy(benchmark::State& state) {
  const auto simd = static_cast<SimdWidth>(state.range(0));
  if (!has_kernel(simd)) {
    state.SkipWithError("this machine has no such packets");
    return;
  }
  std::vector<double> image, gradient;
  double within = 0;
  for (auto _ : state) {
    for (unsigned seed = 0; seed < kBenches; ++seed) {
      const FastErrors errors = fast_errors(workshop(seed, 150), seed % 2 == 0 ? 1 : 3, simd);
      double worst = 0;
      for (const auto& [name, error] : errors.gradients) worst = std::max(worst, error);
      image.push_back(std::max(errors.image, errors.value_only));
      gradient.push_back(worst);
      if (image.back() < 1e-6 && worst < 1e-4) within += 1.0 / kBenches;
    }
  }
  for (std::vector<double>* v : {&image, &gradient}) std::sort(v->begin(), v->end());
  state.counters["image_median"] = image[image.size() / 2];
  state.counters["image_worst"] = image.back();
  state.counters["gradient_median"] = gradient[gradient.size() / 2];
  state.counters["gradient_worst"] = gradient.back();
  state.counters["within"] = within;
  state.SetLabel(std::to_string(kernel_lanes(simd)) + " lanes");
}
BENCHMARK(FastPathAccuracy)
    ->ArgName("width")
    ->Arg(static_cast<int>(SimdWidth::generic))
    ->Arg(static_cast<int>(SimdWidth::avx2))
    ->Arg(static_cast<int>(SimdWidth::avx512))
    ->Iterations(1)
    ->Repetitions(1)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace burin
