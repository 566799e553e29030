// A board under an LED panel that nobody told of, photographed by the point sampler. Taken for a point, its lamp is a
// centimeter off and grooves are rougher by a tenth. refine finds its two sides and their direction, and with them all
// that they had changed.
#include <gtest/gtest.h>

#include <cmath>

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

TEST(RefinePanel, ItsSidesAreFoundAndAllElseBesideThem) {
  const TemporaryFolder folder;
  Json truth = photographed_board("panel", 9, "lamp", {60, 60, 0}, 6);
  make_photos_smaller(truth);
  const Eigen::Vector3d position(69, -319, 452.5), axis = (Eigen::Vector3d(60, 60, 0) - position).normalized();
  Json& lamp = truth["lights"][0];
  lamp["axis"] = {axis.x(), axis.y(), axis.z()};
  lamp["falloff_exponent"] = 1;  // as a plane's
  lamp["panel_mm"] = {120, 60};
  lamp["turn_deg"] = 30;
  simulate(folder.write("truth.json", truth.dump(1)), folder / "photos-of-it");
  const Session session = read_session(folder / "photos-of-it" / "session.json");
  const Board board = read_board(session.board);
  const Calibration calibrated = calibrate(session, board);

  const Bench bench = refine(session, board, Sent(read_scratches(board.scratches)), calibrated.bench, {}).bench;
  const Light& found = bench.lights[0];
  ASSERT_TRUE(found.size.panel_sigma_mm && found.size.turn_sigma_deg && found.position_sigma_mm);
  EXPECT_NEAR(found.size.panel_mm.x(), 120, 5);
  EXPECT_NEAR(found.size.panel_mm.y(), 60, 5);
  EXPECT_NEAR(found.size.turn_deg, 30, 4);
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(found.position_mm[i], position[i], 4 * (*found.position_sigma_mm)[i]);
  EXPECT_LT(found.position_sigma_mm->norm(), 6);
  EXPECT_NEAR(bench.material.alpha / 0.06, 1, 0.02);
  EXPECT_NEAR(bench.material.depth_um / 15, 1, 0.02);
  EXPECT_NEAR(bench.material.base_alpha / 0.12, 1, 0.01);
  // Told again by the same photos, not held as if a person had told it.
  EXPECT_TRUE(bench.verdict.count(parameter::light_size("lamp")));
  EXPECT_EQ(bench.verdict.at(parameter::light_size("lamp")).source, Source::measured);
}

}  // namespace
}  // namespace burin
