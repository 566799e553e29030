// Speed of one rendered view on the fast path, one thread: whole pairs per second (found, clipped, evaluated,
// scattered, differentiated) for each width of packets, and how time grows with the number of scratches.
//
// `of_peak` is the share of the multiply-add peak, measured in the same run, that one interval's moments with their
// derivatives would take for each pair: counted operations of the integral alone (footprint_integral_bench), none of
// geometry, clipping, finding and scattering. So it is a lower bound of the share in use.
#include <benchmark/benchmark.h>
#include <tbb/global_control.h>

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "burin/base/simd_width.h"
#include "burin/render/view_renderer.h"
#include "tests/bench/interval_work.h"
#include "tests/bench/multiply_add_peak.h"
#include "tests/bench/paper_scene.h"

namespace burin {
namespace {

/// Times a view of 512 x 512 pixels, forward and backward or forward alone, on one thread.
void time_view(benchmark::State& state, const RenderOptions& options, int count, bool backward, bool check) {
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const ViewScene scene = paper_scene(paper_grid(512));
  Carved carved = in_metal(paper_scratches(count));
  const Image weights = random_weights(512, 512);
  ViewRenderer renderer(scene, options);
  Image image;
  ScratchGradients gradients;
  double nudge_mm = 1e-6;
  const auto once = [&] {
    // Scratches that lie where they lay would be found once.
    carved.scratches.x0_mm[0] += nudge_mm;
    nudge_mm = -nudge_mm;
    if (!backward) {
      renderer.forward(carved, image);
      return;
    }
    renderer.forward_with_jacobian(carved, image);
    gradients.resize(carved.size());
    renderer.backward(weights, gradients);
  };
  once();  // takes its memory from the system
  for (auto _ : state) once();
  const auto pairs = static_cast<double>(renderer.pair_count());
  const auto all = pairs * static_cast<double>(state.iterations());
  const int lanes = kernel_lanes(options.simd);
  state.counters["pairs"] = pairs;
  state.counters["pairs/s"] = benchmark::Counter(all, benchmark::Counter::kIsRate);
  state.counters["ns/pair"] = benchmark::Counter(1e-9 * all, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
  state.counters["of_peak"] =
      benchmark::Counter(all * operations_per_interval(IntervalWork(2048), backward) / multiply_add_peak(lanes),
                         benchmark::Counter::kIsRate);
  state.SetLabel(std::to_string(lanes) + " lanes" +
                 (!backward                    ? ", value only"
                  : options.material_gradients ? ", both ends, wt, d and alpha"
                                               : ", both ends"));
  if (check) report_correctness(state, scene, carved.scratches, options.simd);
}

void WholePairs(benchmark::State& state) {
  const auto simd = static_cast<SimdWidth>(state.range(0));
  if (!has_kernel(simd)) {
    state.SkipWithError("this machine has no such packets");
    return;
  }
  time_view(state, {1, false, state.range(1) != 0, simd}, 80000, true, true);
}
BENCHMARK(WholePairs)
    ->ArgNames({"width", "material"})
    ->ArgsProduct({{static_cast<int>(SimdWidth::generic), static_cast<int>(SimdWidth::avx2),
                    static_cast<int>(SimdWidth::avx512)},
                   {0, 1}})
    ->Unit(benchmark::kMillisecond);

void ForwardOnly(benchmark::State& state) { time_view(state, {}, 80000, false, false); }
BENCHMARK(ForwardOnly)->Unit(benchmark::kMillisecond);

/// Time a pixel of a groove for other cross-sections: a burr is a strip beside its groove, and counts with it.
void OtherSections(benchmark::State& state) {
  enum Section : std::int64_t { kPaper, kFlanks, kBurrs, kBurrsInDouble };
  const std::int64_t section = state.range(0);
  const bool backward = state.range(1) != 0;
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  ViewScene scene = paper_scene(paper_grid(512));
  scene.tool_width_um = 320;
  scene.material.depth_um = 14;
  const Carved carved = in_metal(paper_scratches(4000));
  const std::size_t pairs = [&] {
    ViewRenderer paper(scene, {});
    Image image;
    paper.forward(carved, image);
    return paper.pair_count();
  }();
  GrooveProfile& profile = scene.material.profile;
  if (section != kPaper) {
    profile.kind = GrooveProfile::Kind::rounded_v;
    profile.flank_deg = 24;
    profile.across = 1.4;
  }
  if (section >= kBurrs) {
    profile.burr_left_um = 1.1;
    profile.burr_right_um = 0.7;
  }
  const Image weights = random_weights(512, 512);
  RenderOptions options;
  options.use_double = section == kBurrsInDouble;
  options.material_gradients = state.range(1) > 1;
  ViewRenderer renderer(scene, options);
  Image image;
  for (auto _ : state) {
    if (!backward) {
      renderer.forward(carved, image);
      continue;
    }
    renderer.forward_with_jacobian(carved, image);
    ScratchGradients gradients;
    renderer.backward(weights, gradients);
  }
  state.counters["pairs"] = static_cast<double>(pairs);
  state.counters["ns/pair"] =
      benchmark::Counter(1e-9 * static_cast<double>(pairs) * static_cast<double>(state.iterations()),
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
  const std::array<std::string, 4> names{"the paper's", "flanks", "flanks and burrs", "flanks and burrs, in double"};
  const std::array<std::string, 3> modes{"value only", "both ends", "both ends, wt, d and alpha"};
  state.SetLabel(names[static_cast<std::size_t>(section)] + ": " + modes[static_cast<std::size_t>(state.range(1))]);
}
BENCHMARK(OtherSections)
    ->ArgNames({"section", "backward"})
    ->ArgsProduct({{0, 1, 2, 3}, {0, 1, 2}})
    ->Unit(benchmark::kMillisecond);

/// What a photo asks for: each pixel's derivatives by metal, lamp, machine, bow and pose.
void PhotoSlopes(benchmark::State& state) {
  const bool flanks = state.range(0) != 0, in_double = state.range(1) != 0;
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  ViewScene scene = paper_scene(paper_grid(512));
  scene.tool_width_um = 320;
  scene.material.depth_um = 14;
  if (flanks) {
    GrooveProfile& profile = scene.material.profile;
    profile.kind = GrooveProfile::Kind::rounded_v;
    profile.flank_deg = 24;
    profile.across = 1.4;
    profile.burr_left_um = 1.1;
    profile.burr_right_um = 0.7;
  }
  const Carved carved = in_metal(paper_scratches(20000));
  CameraView camera;
  camera.T_camera_board = Eigen::Isometry3d(Eigen::Translation3d(-scene.camera_center_mm));
  camera.surface.size_mm = {300, 300};
  std::vector<SceneParameter> parameters{SceneParameter::alpha, SceneParameter::depth_um, SceneParameter::base_alpha};
  for (int k = static_cast<int>(SceneParameter::light_x_mm); k <= static_cast<int>(SceneParameter::light_z_mm); ++k)
    parameters.push_back(static_cast<SceneParameter>(k));
  for (int k = static_cast<int>(SceneParameter::machine_00); k <= static_cast<int>(SceneParameter::bow_2_mm); ++k)
    parameters.push_back(static_cast<SceneParameter>(k));
  const auto workspace = make_render_workspace();
  for (auto _ : state)
    benchmark::DoNotOptimize(render_with_derivatives(scene, camera, carved, parameters, {1, in_double}, workspace));
  state.SetLabel(std::string(flanks ? "flanks and burrs" : "the paper's") + (in_double ? ", in double" : ""));
}
BENCHMARK(PhotoSlopes)->ArgNames({"flanks", "double"})->ArgsProduct({{0, 1}, {0, 1}})->Unit(benchmark::kMillisecond);

/// Time per pair as scratches grow in number.
void Scaling(benchmark::State& state) {
  time_view(state, {1, false, false}, static_cast<int>(state.range(0)), true, false);
}
BENCHMARK(Scaling)
    ->ArgName("scratches")
    ->Arg(10000)
    ->Arg(30000)
    ->Arg(100000)
    ->Arg(300000)
    ->Arg(1000000)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace burin
