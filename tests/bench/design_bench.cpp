// The paper's two workloads, whole iterations as burin/optimize/design.cpp makes them: every view rendered with its
// Jacobian, gamma curve, loss, back to the scratches' ends, one step of Adam. With E_p alone and with E_p + Gram, on
// one thread and on two. `s/100`: wall time of 100 iterations; `cpu_s/100`: processor time of all threads. The
// scratches move meanwhile, as they do in a design.
//
// `loss_ratio`: the loss after the timed iterations over that before them (an iteration that does not descend is not
// worth timing). `allocations`: calls of malloc and its like in an iteration, over the second half of them.
// `image_rms`, `gradient_rms`: against the double path at the start, first view.
#include <benchmark/benchmark.h>
#include <tbb/global_control.h>

#include <cmath>
#include <string>
#include <vector>

#include "burin/optimize/loss/adam.h"
#include "burin/optimize/loss/loss.h"
#include "tests/allocations.h"
#include "tests/bench/paper_scene.h"

namespace burin {
namespace {

constexpr int kPixels = 512;
constexpr int kIterations = 100;

/// A picture for a view: a disc before a gradient with stripes, turned with the view.
Image target_picture(int view) {
  Image picture(kPixels, kPixels, 1);
  const double turn = 1.1 * view;
  for (int y = 0; y < kPixels; ++y)
    for (int x = 0; x < kPixels; ++x) {
      const double u = (x + 0.5) / kPixels - 0.5, v = (y + 0.5) / kPixels - 0.5;
      const double along = u * std::cos(turn) + v * std::sin(turn);
      const double face = 0.3 + 0.4 * (along + 0.5) + 0.1 * std::sin(40 * along);
      picture.at(x, y) = static_cast<float>(std::hypot(u - 0.2 * std::cos(turn), v) < 0.2 ? 0.9 - face : face);
    }
  return picture;
}

double mean_of(const Image& image) {
  double sum = 0;
  for (const float v : image.data) sum += v;
  return sum / static_cast<double>(image.data.size());
}

struct DesignedView {
  ViewRenderer renderer;
  PictureLoss loss;
  double exposure;
  Image radiance, picture, dE_dpicture, dE_dradiance;
};

void PaperDesign(benchmark::State& state) {
  const int count = static_cast<int>(state.range(0)), view_count = static_cast<int>(state.range(1));
  const bool gram = state.range(2) != 0;
  const auto threads = static_cast<std::size_t>(state.range(3));
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
  Scratches scratches = paper_scratches(count);
  RenderOptions options;
  options.material_gradients = false;
  // As burin/optimize/design.cpp has them: one grid, and the memory of one view.
  const std::shared_ptr<const FootprintGrid> grid = paper_grid(kPixels);
  const std::shared_ptr<RenderWorkspace> workspace = make_render_workspace();
  std::vector<DesignedView> views;
  for (int v = 0; v < view_count; ++v) {
    const Image target = with_gamma_offset(target_picture(v));
    views.push_back({ViewRenderer(paper_scene(grid, v, view_count), options, workspace),
                     PictureLoss(target, {}, {1, 0, gram ? 0.01 : 0}),
                     1,
                     {},
                     {},
                     {},
                     {}});
    // As designs start: darker than what would match the target's mean light.
    DesignedView& view = views.back();
    view.renderer.forward(in_metal(scratches), view.radiance);
    view.exposure = 0.3 * std::pow(mean_of(target), 2.2) / mean_of(view.radiance);
  }
  ScratchGradients gradients;
  Carved carved = in_metal(scratches);
  Adam adam_x0(count), adam_y0(count), adam_x1(count), adam_y1(count);

  double first_loss = 0, last_loss = 0;
  std::size_t pairs = 0, from_heap = 0, counted = 0;
  int iteration = 0;
  for (auto _ : state) {
    const std::size_t before = allocations();
    gradients.resize(scratches.size());
    double loss = 0;
    carved.scratches = scratches;
    for (DesignedView& v : views) {
      v.renderer.forward_with_jacobian(carved, v.radiance);
      picture_from_radiance(v.radiance, v.exposure, v.picture);
      loss += v.loss.evaluate(v.picture, v.dE_dpicture).total;
      radiance_gradient(v.radiance, v.exposure, v.picture, v.dE_dpicture, v.dE_dradiance);
      v.renderer.backward(v.dE_dradiance, gradients);
      pairs += v.renderer.pair_count();
    }
    const double rate = 1e-3 * kPaperBoard_mm;
    adam_x0.step(scratches.x0_mm, gradients.x0_mm, rate);
    adam_y0.step(scratches.y0_mm, gradients.y0_mm, rate);
    adam_x1.step(scratches.x1_mm, gradients.x1_mm, rate);
    adam_y1.step(scratches.y1_mm, gradients.y1_mm, rate);
    if (iteration == 0) first_loss = loss;
    last_loss = loss;
    if (iteration++ >= kIterations / 2) {
      from_heap += allocations() - before;
      ++counted;
    }
  }
  state.counters["s/100"] = benchmark::Counter(static_cast<double>(state.iterations()) / 100,
                                               benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
  state.counters["pairs"] = static_cast<double>(pairs) / static_cast<double>(state.iterations());
  state.counters["allocations"] = static_cast<double>(from_heap) / static_cast<double>(counted);
  state.counters["loss_ratio"] = last_loss / first_loss;
  report_correctness(state, paper_scene(grid, 0, view_count), paper_scratches(count), options.simd);
}
BENCHMARK(PaperDesign)
    ->ArgNames({"scratches", "views", "gram", "threads"})
    ->ArgsProduct({{40000}, {2}, {0, 1}, {1, 2}})
    ->ArgsProduct({{80000}, {5}, {0, 1}, {1, 2}})
    ->Iterations(kIterations)
    ->MeasureProcessCPUTime()
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace burin
