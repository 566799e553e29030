// A board whose grooves have burrs that nobody told of, photographed by the point sampler. They hide: the photos ask
// for no other cross-section until everything else has been freed, and then contradict each other where the steepest
// walls glint. refine asks once more there, finds them, and with them the depth that they had changed.
#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "burin/calib/calibrate.h"
#include "burin/calib/refine.h"
#include "burin/capture/session.h"
#include "burin/scene/parameter_name.h"
#include "burin/scene/scratches.h"
#include "burin/simulate/simulated_camera.h"
#include "tests/calib/photographed_board.h"
#include "tests/temporary_folder.h"

namespace burin {
namespace {

// The board as refine finds it from its photos, its cross-section untold.
Bench refined_with_burrs(Json truth, const Json& profile) {
  const TemporaryFolder folder;
  make_photos_smaller(truth);
  truth["material"]["profile"] = profile;
  simulate(folder.write("truth.json", truth.dump(1)), folder / "photos-of-it");
  const Session session = read_session(folder / "photos-of-it" / "session.json");
  Board board = read_board(session.board);
  board.material.profile = {};  // nobody told
  const Calibration calibrated = calibrate(session, board);
  return refine(session, board, Sent(read_scratches(board.scratches)), calibrated.bench, {}).bench;
}

// Without the second question: no burrs, and depth 8 % too large.
TEST(RefineBurrs, ThatHideAreFoundAndTheDepthBesideThem) {
  const Bench bench = refined_with_burrs(
      photographed_board("burrs", 6, "lamp", {60, 60, 0}, 8),
      {{"kind", "paper"}, {"tip_radius_um", 100}, {"burr_height_um", {1.3, 1.1}}, {"burr_width_um", 10}});
  const GrooveProfile& found = bench.material.profile;
  const MaterialSigma& sigma = bench.material_sigma;
  ASSERT_TRUE(sigma.burr_left_um && sigma.burr_right_um);
  EXPECT_GT(found.burr_left_um, 0.3);
  EXPECT_GT(found.burr_right_um, 0.3);
  // Burrs trade with roughness and depth, and say so.
  EXPECT_NEAR(found.burr_left_um, 1.3, 3 * *sigma.burr_left_um);
  EXPECT_NEAR(found.burr_right_um, 1.1, 3 * *sigma.burr_right_um);
  EXPECT_GT(*sigma.burr_left_um, 0.25 * found.burr_left_um);
  EXPECT_LT(*sigma.burr_left_um, 0.5 * found.burr_left_um);
  EXPECT_NEAR(bench.material.depth_um / 15, 1, 0.03);
  const auto depth = bench.verdict.find(parameter::kDepth);
  ASSERT_NE(depth, bench.verdict.end());
  ASSERT_TRUE(depth->second.sigma);
  EXPECT_LT(100 * std::abs(bench.material.depth_um / 15 - 1), 3 * *depth->second.sigma);  // %
}

// Each alone takes up what the others do.
TEST(RefineBurrs, FlanksAndRoughnessAcrossAreFoundBesideThem) {
  Json truth = photographed_board("burrs", 7, "lamp", {60, 60, 0}, 8);
  truth["scratches"]["random"]["count"] = 900;
  const Bench bench = refined_with_burrs(std::move(truth), {{"kind", "rounded-v"},
                                                            {"tip_radius_um", 100},
                                                            {"flank_deg", 23},
                                                            {"burr_height_um", {0.9, 0.6}},
                                                            {"burr_width_um", 11},
                                                            {"alpha_across", 1.35}});
  const GrooveProfile& found = bench.material.profile;
  const MaterialSigma& sigma = bench.material_sigma;
  ASSERT_TRUE(sigma.flank_deg && sigma.across && sigma.burr_left_um);
  EXPECT_NEAR(found.flank_deg, 23, 1);
  EXPECT_NEAR(found.across, 1.35, 0.1);
  EXPECT_NEAR(found.burr_left_um + found.burr_right_um, 1.5, 0.6);
  EXPECT_NEAR(bench.material.depth_um / 15, 1, 0.04);
}

}  // namespace
}  // namespace burin
