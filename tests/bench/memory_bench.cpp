// The most memory that a design of 1,000,000 scratches with eight views of 2048 x 2048 pixels holds: resident set of a
// process of its own that makes the views' renderers and one iteration through all of them.
#include "tests/bench/memory_bench.h"

#include <benchmark/benchmark.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <new>
#include <string>
#include <vector>

#include "tests/bench/paper_scene.h"

namespace burin {
namespace {

constexpr int kScratches = 1000000, kViews = 8, kPixels = 2048;

double peak_resident_gb() {
  rusage use{};
  getrusage(RUSAGE_SELF, &use);
  return 1024e-9 * static_cast<double>(use.ru_maxrss);
}

void PeakMemory(benchmark::State& state) {
  std::string program(4096, '\0');
  program.resize(std::max<ssize_t>(0, readlink("/proc/self/exe", program.data(), program.size())));
  for (auto _ : state) {
    const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen(("'" + program + "' --peak-memory").c_str(), "r"), pclose);
    double scenes = 0, peak = 0, pairs = 0, whole = 0;
    if (!pipe || fscanf(pipe.get(), "%lf %lf %lf %lf", &scenes, &peak, &pairs, &whole) != 4) {
      state.SkipWithError("the process that was to be measured did not answer");
      return;
    }
    state.counters["scenes_GB"] = scenes;
    state.counters["peak_GB"] = peak;
    state.counters["pairs"] = pairs;
    if (whole == 0) state.SetLabel("at least: it ran out of the memory it was allowed");
  }
}
BENCHMARK(PeakMemory)->Iterations(1)->Repetitions(1)->Unit(benchmark::kSecond);

}  // namespace

int print_peak_memory() {
  // Not beyond what is reasonable, nor what the machine has free: the answer is then a lower bound.
  const double free_bytes = static_cast<double>(sysconf(_SC_AVPHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
  const auto most = static_cast<rlim_t>(std::min(8e9, 0.6 * free_bytes));
  const rlimit limit{most, most};
  setrlimit(RLIMIT_AS, &limit);
  double scenes = 0, pairs = 0;
  int whole = 1;
  try {
    const Scratches scratches = paper_scratches(kScratches);
    RenderOptions options;
    options.material_gradients = false;
    std::vector<ViewRenderer> renderers;
    const std::shared_ptr<RenderWorkspace> workspace = make_render_workspace();
    {
      const std::shared_ptr<const FootprintGrid> grid = paper_grid(kPixels);
      for (int v = 0; v < kViews; ++v) renderers.emplace_back(paper_scene(grid, v, kViews), options, workspace);
    }
    scenes = peak_resident_gb();
    const Image weights = random_weights(kPixels, kPixels);
    Image radiance;
    ScratchGradients gradients;
    gradients.resize(scratches.size());
    for (ViewRenderer& renderer : renderers) {
      renderer.forward_with_jacobian(in_metal(scratches), radiance);
      renderer.backward(weights, gradients);
      pairs += static_cast<double>(renderer.pair_count());
    }
  } catch (const std::bad_alloc&) {
    whole = 0;
  }
  std::printf("%.9g %.9g %.9g %d\n", scenes, peak_resident_gb(), pairs, whole);
  return 0;
}

}  // namespace burin
