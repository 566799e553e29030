// A board photographed under its lamp in a room with a window (by the point sampler, which draws directions and shares
// no table with the renderer): refine takes the room as given and finds how bright it was, and the grooves as well as
// in the dark.
#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "burin/calib/calibrate.h"
#include "burin/calib/hold_out.h"
#include "burin/calib/refine.h"
#include "burin/capture/session.h"
#include "burin/capture/simulator/simulated_camera.h"
#include "burin/render/error.h"
#include "burin/render/far_light.h"
#include "burin/render/files/json_file.h"
#include "burin/render/parameter_name.h"
#include "burin/render/scratches.h"
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

Json pose_json(const Vector3d& eye, const Vector3d& aim) {
  const Vector3d z = (aim - eye).normalized(), x = z.cross(Vector3d::UnitY()).normalized(), y = z.cross(x);
  Json rows = Json::array();
  for (const Vector3d& axis : {x, y, z}) rows.push_back({axis.x(), axis.y(), axis.z(), -axis.dot(eye)});
  rows.push_back({0, 0, 0, 1});
  return rows;
}

Json truth_of_room() {
  Json truth = Json::parse(R"({
    "format": "burin/rig-truth", "version": 1, "name": "room", "seed": 6, "samples": 64, "samples_plain": 9,
    "board": { "size_mm": [120, 120], "carve_mm": [[20, 20], [100, 100]],
               "tags": { "family": "tagStandard41h12", "z_mm": 0.1, "sigma_mm": 0.1, "white_albedo": 0.85,
                         "black_albedo": 0.04, "quiet_mm": 0.5, "list": [] },
               "tool": { "width_um": 400 } },
    "believed": { "material": { "alpha": 0.05, "depth_um": 13, "base_alpha": 0.1, "f0": [0.91, 0.92, 0.92] } },
    "material": { "alpha": 0.06, "depth_um": 15, "base_alpha": 0.12, "f0": [0.91, 0.92, 0.92] },
    "scratches": { "random": { "count": 2500, "length_mm": [3, 5], "seed": 4211 } },
    "camera": { "lensmodel": "LENSMODEL_OPENCV4", "imagersize": [800, 640],
                "intrinsics": [2054, 2053, 401.3, 317.9, -0.07, 0.05, 0.0002, -0.0001] },
    "sensor": { "channels": 1, "bits": 12, "encoding": "linear", "gain": 11500, "full_well_e": 18000, "read_noise_e": 9 },
    "lights": [ { "id": "lamp", "position_mm": [69, -319, 452.5], "intensity": [320000, 320000, 320000] },
                { "id": "room", "surroundings": { "picture": "room.exr", "frame": "board" } } ],
    "psf_sigma_px": 0.45,
    "background": { "albedo": [0.03, 0.03, 0.03], "noise": 0.4, "z_mm": -60 },
    "exif": { "make": "Altair", "model": "M07", "focal_mm": 50 }, "session": true, "views": []
  })");
  truth["lights"][1]["surroundings"]["intensity"] = {kBrighter, kBrighter, kBrighter};
  int id = 0;
  for (const double y : {10., 35., 60., 85., 110.})
    for (const double x : {10., 35., 60., 85., 110.})
      if (x == 10 || x == 110 || y == 10 || y == 110)
        truth["board"]["tags"]["list"].push_back({{"id", id++}, {"center_mm", {x, y}}, {"size_mm", 10}});
  const double degree = std::numbers::pi / 180;
  int n = 0;
  for (const auto& [across, along, distance] : {std::tuple(0., 2., 520.),
                                                {28., 5., 530.},
                                                {-28., 8., 540.},
                                                {12., 25., 520.},
                                                {-15., -22., 530.},
                                                {35., -15., 540.}}) {
    const Vector3d aim(60, 60, 0);
    const double a = across * degree, b = along * degree;
    const Vector3d eye = aim + distance * Vector3d(std::sin(a), std::cos(a) * std::sin(b), std::cos(a) * std::cos(b));
    Json view{{"view", "v" + std::to_string(n)}, {"T_camera_board", pose_json(eye, aim)}};
    for (const auto& [letter, exposure] : {std::pair("a", 0.0125), {"b", 0.0015625}, {"c", 0.0002}})
      view["photos"].push_back({{"file", "photos/v" + std::to_string(n) + letter + ".png"},
                                {"light", "lamp + room"},
                                {"exposure_s", exposure},
                                {"iso", 100},
                                {"f_number", 8}});
    truth["views"].push_back(view);
    ++n;
  }
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
