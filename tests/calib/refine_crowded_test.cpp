// The sample's board, half of whose face grooves cover, as designs do, photographed by the point sampler: as refine
// finds it. Nothing but grooves and lamp is there to be found.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "burin/base/files/json_file.h"
#include "burin/calib/calibrate.h"
#include "burin/calib/refine.h"
#include "burin/capture/session.h"
#include "burin/scene/scratches.h"
#include "burin/simulate/simulated_camera.h"
#include "tests/places.h"
#include "tests/temporary_folder.h"

namespace burin {
namespace {

Json sample() { return read_json(places::source() + "/samples/small-bench/truth.json", "burin/rig-truth", 1); }

Bench refined_crowded(Json truth, const std::vector<std::string>& views) {
  truth["session"] = true;
  const TemporaryFolder folder;
  SimulateOptions options;
  options.views = views;
  simulate(folder.write("truth.json", truth.dump(1)), folder / "photos-of-it", options);
  const Session session = read_session(folder / "photos-of-it" / "session.json");
  const Board board = read_board(session.board);
  const Calibration calibrated = calibrate(session, board);
  return refine(session, board, Sent(read_scratches(board.scratches)), calibrated.bench, {}).bench;
}

void expect_nothing_else(const Bench& bench) {
  EXPECT_TRUE(bench.material.profile.is_paper());
  EXPECT_FALSE(bench.stray);
  EXPECT_TRUE(bench.lights[0].size.is_point());
  EXPECT_LT(bench.lights[0].falloff_exponent, 0.3);  // next to none
}

// What coarse pixels miss of grooves that cover each other was taken for flanks and burrs: depth 6 % too small.
TEST(RefineCrowded, GroovesThatAddAskForNothingElse) {
  const Bench bench = refined_crowded(sample(), {});
  expect_nothing_else(bench);
  EXPECT_EQ(bench.crossings, Crossings::add);
  EXPECT_NEAR(bench.material.depth_um / 15, 1, 0.005);
  EXPECT_NEAR(bench.material.alpha / 0.06, 1, 0.005);
  EXPECT_NEAR(bench.material.base_alpha / 0.12, 1, 0.002);
}

// As crowded on a quarter of the face: depth 7 % too small, flanks and burrs.
TEST(RefineCrowded, GroovesThatCutEachOtherAskForNothingElse) {
  Json truth = sample();
  truth["overlap"] = "deepest";
  truth["board"]["carve_mm"] = {{40, 40}, {80, 80}};
  truth["scratches"]["random"]["count"] = 2000;
  const Bench bench = refined_crowded(std::move(truth), {"d0", "d1", "c0", "c2", "c4", "c6"});
  expect_nothing_else(bench);
  EXPECT_EQ(bench.crossings, Crossings::deepest);
  EXPECT_NEAR(bench.material.depth_um / 15, 1, 0.015);
  EXPECT_NEAR(bench.material.alpha / 0.06, 1, 0.01);
  EXPECT_NEAR(bench.material.base_alpha / 0.12, 1, 0.002);
}

}  // namespace
}  // namespace burin
