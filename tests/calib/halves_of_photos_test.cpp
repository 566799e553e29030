// What is proved: on photographs that brute force rendered, halves of the photos solved to first order from the optimum
// of all (burin/calib/verdict/half_samples.h) are where solving again on those photos alone ends, within a fraction of
// the difference between the halves: the check that the verdict rests on is the re-solve, at no cost.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "burin/base/median.h"
#include "burin/calib/light/light_samples.h"
#include "burin/calib/photo/bench_unknowns.h"
#include "burin/calib/photo/machine_map.h"
#include "burin/calib/photo/photo_fit.h"
#include "burin/calib/photo/photo_problem.h"
#include "burin/calib/photo/photo_weights.h"
#include "burin/calib/verdict/half_samples.h"
#include "burin/calib/verdict/identifiability.h"
#include "burin/calib/verdict/photo_uncertainty.h"
#include "tests/calib/rig_bench.h"

namespace burin {
namespace {

TEST(HalvesOfPhotos, AreWhereSolvingAgainEnds) {
  BURIN_NEEDS_RIG("a");
  const Rig rig = read_rig("a", {"v01", "v03", "v05", "v07", "v09", "v11"});
  Bench bench = rig.true_poses;
  std::vector<Finding> findings;
  const std::vector<MergedView> merged = merge_session(rig.session);
  const std::vector<LightView> views = make_light_views(merged, rig.board, bench, findings);

  Problem all = make_problem(rig.board, rig.sent, bench);
  for (const LightSample& s : gather_light_samples(views, rig.board, bench, rig.sent))
    if (s.kind != SampleKind::face && s.value > 0) all.paper.push_back(s);
  // A start: the solve's own way there is refine_test's.
  bench.material.alpha = 0.08;
  bench.material.depth_um = 14;
  bench.material.base_alpha = 0.18;
  bench.machine_affine = true_affine(rig.truth);
  bench.lights[0].position_mm = true_lamp_position(rig.truth);
  State state = state_of(bench, all);
  const double white = all.paper.front().value;
  const double unit = paper_radiance(LampModel<double>{bench.lights[0].position_mm, 0, {0, 0}, 0}, 0.0,
                                     rig.board.tags.white_albedo, all.paper.front());
  state.lamps[0][3] = std::log(white / unit);
  std::vector<double> sizes;
  for (const LightView& view : views) sizes.push_back(pixel_mm(view, bench));
  const int bin = static_cast<int>(std::lround(2.0 / median_of(sizes)));
  all.photos = photos_at(views, bin, rig.board, bench, std::exp(state.shared[unknown::log_blur]));
  Stage stage;
  stage.free(Group::blur);
  for (int round = 0; round < 2; ++round) {
    weigh_photos(all, state);
    solve(all, stage, 15, 1e-8, state, {}, "");
  }
  const Uncertainty u = uncertainty_of(all, stage, state);
  const EquationsInParts parts = light_in_parts(all, state, u);
  const HalfSamples halves = half_samples(parts);
  ASSERT_EQ(parts.pairs.size(), 3U);

  // The first split: the first photo of each pair.
  for (const bool first : {true, false}) {
    Problem half = all;
    half.photos.clear();
    half.paper.clear();
    for (const auto& pair : parts.pairs) {
      const std::size_t k = first ? pair.first : pair.second;
      for (LightSample s : all.paper)
        if (s.light_view == k) {
          s.light_view = half.photos.size();
          half.paper.push_back(s);
        }
      half.photos.push_back(all.photos[k]);
    }
    State again = state;
    solve(half, stage, 15, 1e-9, again, {}, "");
    const Eigen::VectorXd& step = first ? halves.splits[0].step_a : halves.splits[0].step_b;
    for (const auto& [name, index] : {std::pair("alpha", unknown::log_alpha),
                                      {"depth", int{unknown::log_depth}},
                                      {"base_alpha", int{unknown::log_base_alpha}},
                                      {"lamp x", int{unknown::lamp_position}},
                                      {"lamp y", unknown::lamp_position + 1},
                                      {"lamp z", unknown::lamp_position + 2},
                                      {"machine x", machine_index(0, 2)},
                                      {"machine y", machine_index(1, 2)}}) {
      const bool of_lamp = index >= kSharedUnknowns;
      const double moved = of_lamp ? again.lamps[0][index - kSharedUnknowns] - state.lamps[0][index - kSharedUnknowns]
                                   : again.shared[index] - state.shared[index];
      const double predicted = step[global_index(index, 0)];
      const double between =
          std::abs(halves.splits[0].step_a[global_index(index, 0)] - halves.splits[0].step_b[global_index(index, 0)]);
      std::printf("  %s: %-10s solved again %10.3g, to first order %10.3g, between the halves %10.3g\n",
                  first ? "first " : "second", name, moved, predicted, between);
      EXPECT_NEAR(moved, predicted, 0.2 * between + 0.2 * u.sigma(global_index(index, 0))) << name;
    }
  }
}

}  // namespace
}  // namespace burin
