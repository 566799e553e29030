// A board photographed under its lamp in a room with a window (by the point sampler, which draws directions and shares
// no table with the renderer): refine takes the room as given and finds how bright it was, and the grooves as well as
// in the dark.
#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "burin/base/error.h"
#include "burin/calib/calibrate.h"
#include "burin/calib/hold_out.h"
#include "burin/calib/refine.h"
#include "burin/capture/session.h"
#include "burin/pictures/picture.h"
#include "burin/scene/far_light.h"
#include "burin/scene/parameter_name.h"
#include "burin/scene/scratches.h"
#include "burin/simulate/simulated_camera.h"
#include "tests/calib/photographed_board.h"
#include "tests/temporary_folder.h"

namespace burin {
namespace {

using Eigen::Vector3d;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr double kBrighter = 1.3;  // than the picture of the room says

// Walls that grow brighter towards the ceiling, and a window 35 degrees off the board's axis.
Image room_picture() {
  constexpr int kHeight = 128;
  Image room(2 * kHeight, kHeight, 3);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < 2 * kHeight; ++x) {
      const double lean_deg = (y + 0.5) * 180 / kHeight, azimuth_deg = (x + 0.5) * 180 / kHeight;
      const bool window = std::abs(lean_deg - 35) < 9 && std::abs(azimuth_deg - 200) < 16;
      const double value = window ? 1.2 : 0.012 + 0.02 * std::max(0.0, std::cos(lean_deg * std::numbers::pi / 180));
      for (int c = 0; c < 3; ++c) room.at(x, y, c) = static_cast<float>(value);
    }
  return room;
}

Json truth_of_room() {
  Json truth = photographed_board("room", 6, "lamp + room", {60, 60, 0}, 6);
  truth["samples"] = 64;
  Json room = {{"id", "room"}, {"surroundings", {{"picture", "room.exr"}, {"frame", "board"}}}};
  room["surroundings"]["intensity"] = {kBrighter, kBrighter, kBrighter};
  truth["lights"].push_back(room);
  return truth;
}

Light room() {
  Light light = surroundings_light(make_panorama(room_picture(), {}, "room"));
  light.id = "room";
  return light;
}

TEST(RefineInARoom, FindsItsScaleAndTheGroovesAsInTheDark) {
  const TemporaryFolder folder;
  write_picture(room_picture(), folder / "room.exr");
  simulate(folder.write("truth.json", truth_of_room().dump(1)), folder / "photos-of-it");
  const Session session = read_session(folder / "photos-of-it" / "session.json");
  const Board board = read_board(session.board);
  const Sent sent(read_scratches(board.scratches));
  Calibration calibrated = calibrate(session, board);
  ASSERT_EQ(calibrated.bench.lights.size(), 1U);
  EXPECT_EQ(calibrated.bench.lights[0].id, "lamp");
  calibrated.bench.lights.push_back(room());

  const Refinement refined = refine(session, board, sent, calibrated.bench, {});
  const Bench& bench = refined.bench;
  ASSERT_EQ(bench.lights.size(), 2U);
  const Light& found = bench.lights[1];
  EXPECT_FALSE(found.is_near());
  // The sensor's gain is 1 in a measured bench: the room's scale is in units of the lamp's.
  const double gain = bench.lights[0].intensity.mean() / 320000;
  const double scale = found.intensity.mean() / gain;
  EXPECT_NEAR(scale / kBrighter, 1, 0.02);
  ASSERT_TRUE(found.intensity_sigma);
  EXPECT_NEAR(scale, kBrighter, 3 * found.intensity_sigma->mean() / gain);
  EXPECT_TRUE(bench.ambient.isZero());
  const auto verdict = bench.verdict.find(parameter::light_intensity("room"));
  ASSERT_NE(verdict, bench.verdict.end());
  EXPECT_EQ(verdict->second.source, Source::measured);
  EXPECT_NEAR(bench.material.alpha / 0.06, 1, 0.01);
  EXPECT_NEAR(bench.material.depth_um / 15, 1, 0.015);
  EXPECT_NEAR(bench.material.base_alpha / 0.12, 1, 0.02);
  EXPECT_LT((bench.lights[0].position_mm - Vector3d(69, -319, 452.5)).norm(), 3);

  // What was found predicts the photos as well as the fit saw it. They are as noisy as one direction a point is: with
  // four times the points the residual is half as large.
  std::vector<MergedView> merged = photos_for_refine(session, board, calibrated.bench);
  const std::vector<PhotoFit> again = predict_photos(refined, merged, board, sent);
  ASSERT_EQ(again.size(), refined.photos.size());
  for (std::size_t k = 0; k < again.size(); ++k) {
    EXPECT_EQ(again[k].view, refined.photos[k].view);
    EXPECT_NEAR(again[k].residual_to_noise / refined.photos[k].residual_to_noise, 1, 0.05) << again[k].view;
    EXPECT_LT(again[k].residual_rms, 0.1) << again[k].view;
  }
  for (const Finding& told : refined.findings) EXPECT_THAT(told.what, Not(HasSubstr("light room"))) << told.what;

  // All photos or none are taken in it, and none under it alone.
  merged.front().light = "lamp";
  EXPECT_THAT([&] { refine(merged, board, sent, calibrated.bench, {}); },
              ::testing::ThrowsMessage<Error>(
                  AllOf(HasSubstr("photos under \"lamp + room\""), HasSubstr("show room"), HasSubstr("in the dark"))));
  merged.front().light = "room";
  EXPECT_THAT([&] { refine(merged, board, sent, calibrated.bench, {}); },
              ::testing::ThrowsMessage<Error>(HasSubstr("under one near lamp")));
}

}  // namespace
}  // namespace burin
