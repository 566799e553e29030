// Proves: the table of unknowns is whole (indices, scopes and priors fit together, a stage frees what its groups say),
// and every row is linked to a bench: what state_of() reads, put_state() writes back. Not proved: that derivatives by
// the unknowns are right (photo_equations_test).
#include "burin/calib/photo/unknowns.h"

#include <gtest/gtest.h>

#include "burin/calib/photo/bench_unknowns.h"
#include "burin/calib/photo/machine_map.h"
#include "burin/calib/photo/photo_problem.h"

namespace burin {
namespace {

TEST(Unknowns, IndicesFollowFromTheTable) {
  EXPECT_EQ(unknown::log_alpha, 0);
  EXPECT_EQ(unknown::depth_wear, unknown::depth_field + GrooveField::kTerms - 1);
  EXPECT_EQ(unknown::lamp_position, kSharedUnknowns);
  EXPECT_EQ(unknown::pose, kFitUnknowns);
  EXPECT_EQ(unknown::log_paper, unknown::count);
  EXPECT_EQ(first_of("no such unknown"), -1);
  EXPECT_EQ(global_index(unknown::lamp_position, 0), kPaperIndex + 1);
  EXPECT_EQ(global_index(unknown::sides2 + 1, 1), global_count(2) - 1);
  Scope last = Scope::shared;
  for_each_unknown([&](const UnknownRow& row, int first) {
    EXPECT_EQ(first, first_of(row.name));
    EXPECT_GE(row.scope, last) << row.name << " stands behind rows of a later scope";
    EXPECT_LE(row.bounds.at + row.bounds.count, row.size);
    last = row.scope;
  });
}

TEST(Unknowns, AStepBetweenTwoStatesMovesTheOneToTheOther) {
  State from, to;
  from.lamps.resize(2);
  to.lamps.resize(2);
  for (int i = 0; i < kSharedUnknowns; ++i) to.shared[i] = 1 + i;
  to.log_paper[0] = -7;
  for (std::size_t light = 0; light < 2; ++light)
    for (int i = 0; i < kLampUnknowns; ++i) to.lamps[light][i] = 100 * (1.0 + light) + i;
  from.shared[3] = 0.5;
  from.lamps[1][0] = 9;
  const State moved = moved_state(from, step_between(from, to));
  EXPECT_EQ(moved.shared, to.shared);
  EXPECT_EQ(moved.log_paper[0], to.log_paper[0]);
  EXPECT_EQ(moved.lamps, to.lamps);
}

TEST(Unknowns, AStageFreesItsGroups) {
  Stage stage;
  EXPECT_TRUE(stage.frees(Group::machine));
  EXPECT_FALSE(stage.frees(Group::blur));
  EXPECT_FALSE(stage.frees(Group::depth_wear));
  stage.free(FreeField{true, false, true}).free(Group::blur).hold({Group::machine});
  EXPECT_TRUE(stage.frees(Group::depth_linear) && stage.frees(Group::depth_wear) && stage.frees(Group::blur));
  EXPECT_FALSE(stage.frees(Group::depth_quadratic) || stage.frees(Group::machine));
}

TEST(Unknowns, ABenchIsReadAndWrittenBack) {
  Board board;
  board.size_mm = {200, 100};
  board.carve_min_mm = {20, 20};
  board.carve_max_mm = {180, 80};
  Bench bench;
  bench.material = {0.061, 14.2, 0.17, {0.9, 0.9, 0.9}};
  bench.depth_field.terms = {0.07, -0.04, 0.01, 0.02, -0.03, 0.05};
  bench.machine_affine << 1.001, 0.002, -0.3, -0.0015, 0.999, 0.4;
  bench.ambient.setConstant(0.02);
  bench.sensor.vignette = {-0.1, 0.02, -0.003};
  bench.sensor.psf_sigma_px = 1.4;
  Light bare, spot;
  bare.position_mm = {150, -500, 900};
  spot.id = "spot";
  spot.position_mm = {-300, 200, 700};
  spot.axis = Eigen::Vector3d(0.3, -0.1, -0.9).normalized();
  spot.falloff_exponent = 2.5;
  bare.intensity.setConstant(1e6);
  spot.intensity.setConstant(3e6);
  bench.lights = {bare, spot};
  const Sent none;
  Problem problem = make_problem(board, none, bench);
  problem.merged_bin = 2;
  EXPECT_EQ(problem.is_spot, (std::vector<bool>{false, true}));
  const State state = state_of(bench, problem);
  EXPECT_NEAR(std::exp(state.shared[unknown::log_blur]), 0.7, 1e-12);  // in pixels of the merged photos
  EXPECT_NEAR(machine_map(state.shared).shift_mm.y(), -0.0015 * 100 - 0.001 * 50 + 0.4, 1e-12);

  Bench back = bench;
  back.material.alpha = back.material.depth_um = 1;
  back.depth_field = {};
  back.machine_affine.setZero();
  back.lights[1].axis = {0, 0, -1};
  put_state(state, problem, back);
  EXPECT_NEAR(back.material.alpha, 0.061, 1e-15);
  EXPECT_NEAR(back.material.depth_um, 14.2, 1e-12);
  EXPECT_EQ(back.depth_field.terms, bench.depth_field.terms);
  EXPECT_LT((back.machine_affine - bench.machine_affine).norm(), 1e-12);
  EXPECT_EQ(back.sensor.vignette, bench.sensor.vignette);
  EXPECT_NEAR(back.sensor.psf_sigma_px, 1.4, 1e-12);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(back.lights[i].position_mm, bench.lights[i].position_mm);
    EXPECT_NEAR(back.lights[i].intensity.mean(), bench.lights[i].intensity.mean(), 1e-6);
  }
  EXPECT_LT((back.lights[1].axis - spot.axis).norm(), 1e-12);
  EXPECT_EQ(back.lights[1].falloff_exponent, 2.5);
}

}  // namespace
}  // namespace burin
