// A lamp that nobody named and that shines into every photo, photographed by the point sampler: taken for grooves' own
// light it moves their roughness by percents. refine finds where it stands.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "burin/calib/calibrate.h"
#include "burin/calib/photo/stray_light.h"
#include "burin/calib/refine.h"
#include "burin/capture/session.h"
#include "burin/scene/parameter_name.h"
#include "burin/scene/scratches.h"
#include "burin/simulate/simulated_camera.h"
#include "tests/calib/photographed_board.h"
#include "tests/temporary_folder.h"

namespace burin {
namespace {

const Eigen::Vector2d kSize(120, 90);

TEST(StrayLight, ItsNumbersAndItsLampAreTheSame) {
  const StrayNumbers numbers{0.4, -0.7, 0.2, 3.5, 0.01};
  const Light light = stray_light(numbers, kSize);
  EXPECT_NEAR((light.position_mm - Eigen::Vector3d(60, 45, 0)).norm(), 150 / 0.2, 1e-9);
  EXPECT_NEAR(light.intensity[1] / std::pow(150 / 0.2, 2), 3.5, 1e-9);
  EXPECT_NEAR(light.size.disk_mm, 0.1 * 150 / 0.2, 1e-9);
  const StrayNumbers back = stray_numbers(light, kSize);
  for (int i = 0; i < kStrayNumbers; ++i) EXPECT_NEAR(back[i], numbers[i], 1e-12) << i;
}

TEST(StrayLight, SlopesAreDifferences) {
  const StrayNumbers numbers{0.4, -0.7, 0.2, 3.5, 0.01};
  const auto slopes = stray_slopes(numbers, kSize);
  for (int i = 0; i < kStrayNumbers; ++i) {
    constexpr double kStep = 1e-6;
    StrayNumbers above = numbers, below = numbers;
    above[i] += kStep;
    below[i] -= kStep;
    const Light a = stray_light(above, kSize), b = stray_light(below, kSize);
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(slopes(k, i), (a.position_mm[k] - b.position_mm[k]) / (2 * kStep), 1e-4) << k << " by " << i;
    EXPECT_NEAR(slopes(3, i), std::log(a.intensity[0] / b.intensity[0]) / (2 * kStep), 1e-5) << "light by " << i;
  }
}

TEST(RefineStrayLight, ALampThatNobodyNamedIsFoundAndTheGroovesAreAsTheyAre) {
  const TemporaryFolder folder;
  Json truth = photographed_board("stray", 9, "lamp", {60, 60, 0}, 6);
  make_photos_smaller(truth);
  const Eigen::Vector3d other(-240, 200, 480), axis = (Eigen::Vector3d(60, 60, 0) - other).normalized();
  truth["stray_lights"] = Json::array({{{"id", "other"},
                                        {"position_mm", {other.x(), other.y(), other.z()}},
                                        {"axis", {axis.x(), axis.y(), axis.z()}},
                                        {"falloff_exponent", 0},
                                        {"intensity", {32000, 32000, 32000}}}});
  simulate(folder.write("truth.json", truth.dump(1)), folder / "photos-of-it");
  const Session session = read_session(folder / "photos-of-it" / "session.json");
  const Board board = read_board(session.board);
  const Calibration calibrated = calibrate(session, board);

  const Refinement refined = refine(session, board, Sent(read_scratches(board.scratches)), calibrated.bench, {});
  const Bench& bench = refined.bench;
  ASSERT_TRUE(bench.stray && bench.stray->position_sigma_mm && bench.stray->intensity_sigma);
  const auto from_middle = [](const Eigen::Vector3d& p) { return (p - Eigen::Vector3d(60, 60, 0)).normalized(); };
  const double apart = std::acos(from_middle(bench.stray->position_mm).dot(from_middle(other)));
  EXPECT_LT(apart * 180 / std::numbers::pi, 3);
  for (int i = 0; i < 3; ++i)
    EXPECT_NEAR(bench.stray->position_mm[i], other[i], 4 * (*bench.stray->position_sigma_mm)[i]);
  ASSERT_TRUE(bench.verdict.count(parameter::kStray));
  EXPECT_EQ(bench.verdict.at(parameter::kStray).source, Source::measured);
  EXPECT_TRUE(bench.misfits.empty());
  for (const auto& [value, truly, sigma] :
       {std::tuple(bench.material.alpha, 0.06, bench.material_sigma.alpha),
        std::tuple(bench.material.depth_um, 15.0, bench.material_sigma.depth_um),
        std::tuple(bench.material.base_alpha, 0.12, bench.material_sigma.base_alpha)}) {
    ASSERT_TRUE(sigma);
    EXPECT_NEAR(value / truly, 1, 0.02);
    EXPECT_NEAR(value, truly, 3 * *sigma);
  }
}

}  // namespace
}  // namespace burin
