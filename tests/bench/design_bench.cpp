// The paper's two workloads, whole iterations: every view rendered with its Jacobian, gamma curve, loss, back to the
// scratches' ends, one step of Adam. With E_p alone and with E_p + Gram, on one thread and on two. `s/100`: wall time
// of 100 iterations; `cpu_s/100`: processor time of all threads. The scratches move meanwhile, as they do in a design.
// `placed`: scratches run as `burin design` places them, each in the direction that is best for one of the views; else
// anywhere, as designs start that are not searched. `bright`: as `burin design` then repeats iterations, each view
// rendering in most of them only what is bright in it (burin/optimize/design/bright_part.h); else all, as the paper
// does.
//
// `loss_ratio`: the loss after the timed iterations, everything rendered, over that before them (an iteration that does
// not descend is not worth timing). `allocations`: calls of malloc and its like in an iteration, over the second half
// of them. `image_rms`, `gradient_rms`: where all is rendered against the double path at the start, first view; with
// `bright` against all of it after the timed iterations, first view.
#include <benchmark/benchmark.h>
#include <tbb/global_control.h>

#include <cmath>
#include <string>
#include <vector>

#include "burin/optimize/design/bright_part.h"
#include "burin/optimize/design/glint.h"
#include "burin/optimize/loss/adam.h"
#include "burin/optimize/loss/loss.h"
#include "burin/optimize/toolpath/ends.h"
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
  WorkView work;
  BrightPart bright;
  double exposure = 1;
  Image dE_dpicture{}, dE_dradiance{};
};

/// As burin/optimize/design has them: one grid, and the memory of one view.
std::vector<DesignedView> designed_views(int count, bool gram, bool bright) {
  const std::shared_ptr<const FootprintGrid> grid = paper_grid(kPixels);
  const std::shared_ptr<RenderWorkspace> workspace = make_render_workspace();
  RenderOptions options;
  options.material_gradients = false;
  std::vector<DesignedView> views;
  for (int v = 0; v < count; ++v) {
    const Image target = with_gamma_offset(target_picture(v));
    const ViewScene scene = paper_scene(grid, v, count);
    WorkLamp lamp;
    lamp.glint = {"", scene.camera_center_mm, scene.light.position_mm};
    views.push_back({{.spec = {},
                      .lamps = {lamp},
                      .target = {},
                      .renderer = ViewRenderer(scene, options, workspace),
                      .loss = PictureLoss(target, {}, {1, 0, gram ? 0.01 : 0})},
                     {}});
    views.back().bright.apart = bright;
  }
  return views;
}

/// As designs start: darker than what would match the targets' mean light.
void set_exposures(std::vector<DesignedView>& views, const Carved& carved) {
  for (std::size_t v = 0; v < views.size(); ++v) {
    WorkView& work = views[v].work;
    work.renderer.forward(carved, work.radiance);
    const double wanted = mean_of(with_gamma_offset(target_picture(static_cast<int>(v))));
    views[v].exposure = 0.3 * std::pow(wanted, 2.2) / mean_of(work.radiance);
  }
}

/// Turns scratches about their middles, one view after the other, to where they glint best.
void turn_to_views(const std::vector<DesignedView>& views, Scratches& scratches) {
  for (std::size_t i = 0; i < scratches.size(); ++i) {
    const Ends e = ends_of(scratches, i);
    const Eigen::Vector2d middle = (e.a + e.b) / 2;
    const Lean lean = lean_at(views[i % views.size()].work.lamps[0].glint, Eigen::Vector3d(middle.x(), middle.y(), 0));
    const double along = lean.scratch_direction();
    const Eigen::Vector2d half = (e.b - e.a).norm() / 2 * Eigen::Vector2d(std::cos(along), std::sin(along));
    scratches.x0_mm[i] = middle.x() - half.x();
    scratches.y0_mm[i] = middle.y() - half.y();
    scratches.x1_mm[i] = middle.x() + half.x();
    scratches.y1_mm[i] = middle.y() + half.y();
  }
}

/// The loss of what a view shows, with its gradient by radiance.
double loss_of(DesignedView& v) {
  WorkView& w = v.work;
  picture_from_radiance(w.radiance, v.exposure, w.picture);
  const double loss = w.loss.evaluate(w.picture, v.dE_dpicture).total;
  radiance_gradient(w.radiance, v.exposure, w.picture, v.dE_dpicture, v.dE_dradiance);
  return loss;
}

/// What a view's bright part leaves of its picture and gradient, as last seen some iterations before, against all that
/// it shows now.
void report_bright_part(benchmark::State& state, DesignedView& v, const Bench& bench, const Carved& carved) {
  const Board board;
  ScratchGradients gradients[2];
  Image radiance[2];
  for (const int all : {0, 1}) {
    gradients[all].resize(carved.size());
    v.bright.apart = all == 0;
    render_view(v.work, v.bright, bench, carved, true);
    radiance[all] = v.work.radiance;
    loss_of(v);
    view_backward(v.work, v.bright, {bench, board}, carved, v.dE_dradiance, gradients[all]);
  }
  report_differences(state, radiance, gradients);
}

void PaperDesign(benchmark::State& state) {
  const int count = static_cast<int>(state.range(0)), view_count = static_cast<int>(state.range(1));
  const bool gram = state.range(2) != 0, placed = state.range(3) != 0, bright = state.range(4) != 0;
  const auto threads = static_cast<std::size_t>(state.range(5));
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
  Scratches scratches = paper_scratches(count);
  std::vector<DesignedView> views = designed_views(view_count, gram, bright);
  if (placed) turn_to_views(views, scratches);
  Bench bench;
  bench.material = paper_scene(paper_grid(1)).material;
  const Board board;
  ScratchGradients gradients;
  Carved carved = in_metal(scratches);
  set_exposures(views, carved);
  Adam adam_x0(count), adam_y0(count), adam_x1(count), adam_y1(count);

  const auto loss_of_all = [&] {
    double loss = 0;
    for (DesignedView& v : views) {
      v.work.renderer.forward(carved, v.work.radiance);
      loss += loss_of(v);
    }
    return loss;
  };
  const double first_loss = loss_of_all();
  std::size_t pairs = 0, from_heap = 0, counted = 0;
  int iteration = 0;
  for (auto _ : state) {
    const std::size_t before = allocations();
    gradients.resize(scratches.size());
    carved.scratches = scratches;
    for (DesignedView& v : views) {
      if (iteration % kOthersEvery == 0) v.bright.others = {};
      render_view(v.work, v.bright, bench, carved, true);
      loss_of(v);
      view_backward(v.work, v.bright, {bench, board}, carved, v.dE_dradiance, gradients);
      pairs += v.work.renderer.pair_count();
    }
    const double rate = 1e-3 * kPaperBoard_mm;
    adam_x0.step(scratches.x0_mm, gradients.x0_mm, rate);
    adam_y0.step(scratches.y0_mm, gradients.y0_mm, rate);
    adam_x1.step(scratches.x1_mm, gradients.x1_mm, rate);
    adam_y1.step(scratches.y1_mm, gradients.y1_mm, rate);
    if (iteration++ >= kIterations / 2) {
      from_heap += allocations() - before;
      ++counted;
    }
  }
  state.counters["s/100"] = benchmark::Counter(static_cast<double>(state.iterations()) / 100,
                                               benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
  state.counters["pairs"] = static_cast<double>(pairs) / static_cast<double>(state.iterations());
  state.counters["allocations"] = static_cast<double>(from_heap) / static_cast<double>(counted);
  carved.scratches = scratches;
  if (bright)
    report_bright_part(state, views[0], bench, carved);
  else
    report_correctness(state, paper_scene(paper_grid(kPixels), 0, view_count), paper_scratches(count),
                       RenderOptions{}.simd);
  state.counters["loss_ratio"] = loss_of_all() / first_loss;
}
BENCHMARK(PaperDesign)
    ->ArgNames({"scratches", "views", "gram", "placed", "bright", "threads"})
    ->ArgsProduct({{40000}, {2}, {0, 1}, {0}, {0}, {1, 2}})
    ->ArgsProduct({{40000}, {2}, {0}, {1}, {0, 1}, {1, 2}})
    ->ArgsProduct({{80000}, {5}, {0, 1}, {0}, {0}, {1, 2}})
    ->ArgsProduct({{80000}, {5}, {0}, {1}, {0, 1}, {1, 2}})
    ->Iterations(kIterations)
    ->MeasureProcessCPUTime()
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace burin
