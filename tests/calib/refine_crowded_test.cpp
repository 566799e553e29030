// The sample's board, half of whose face grooves cover, as designs do, photographed by the point sampler: as refine
// finds it. Nothing but grooves and lamp is there to be found.
#include <gtest/gtest.h>

#include <array>
#include <nlohmann/json.hpp>
#include <string>
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

// Relative errors: depth, alpha, base_alpha.
void expect_material(const Bench& bench, const Json& truth, const std::array<double, 3>& within) {
  const Json& material = truth["material"];
  EXPECT_NEAR(bench.material.depth_um / material["depth_um"].get<double>(), 1, within[0]);
  EXPECT_NEAR(bench.material.alpha / material["alpha"].get<double>(), 1, within[1]);
  EXPECT_NEAR(bench.material.base_alpha / material["base_alpha"].get<double>(), 1, within[2]);
}

// What coarse pixels miss of grooves that cover each other was taken for flanks and burrs: depth 6 % too small.
TEST(RefineCrowded, GroovesThatAddAskForNothingElse) {
  Json truth = sample();
  truth["overlap"] = "sum";
  const Bench bench = refined_crowded(truth, {});
  expect_nothing_else(bench);
  EXPECT_EQ(bench.crossings, Crossings::add);
  expect_material(bench, truth, {0.005, 0.005, 0.002});
}

// As crowded on a quarter of the face: depth 7 % too small, flanks and burrs.
TEST(RefineCrowded, GroovesThatCutEachOtherAskForNothingElse) {
  Json truth = sample();
  truth["board"]["carve_mm"] = {{40, 40}, {80, 80}};
  truth["scratches"]["random"]["count"] = 2000;
  const Bench bench = refined_crowded(truth, {"d0", "d1", "c0", "c2", "c4", "c6"});
  expect_nothing_else(bench);
  EXPECT_EQ(bench.crossings, Crossings::deepest);
  expect_material(bench, truth, {0.015, 0.01, 0.002});
}

}  // namespace
}  // namespace burin
