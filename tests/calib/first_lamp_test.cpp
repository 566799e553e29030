// What calibrate takes a lamp for before a glint is looked at, on boards photographed by the point sampler: a softbox
// that is no point, tags on paper that shines. Each moved the lamp by decimeters while it was not known of.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "burin/calib/calibrate.h"
#include "burin/calib/light/lamp.h"
#include "burin/calib/light/light_samples.h"
#include "burin/calib/light/photo_faults.h"
#include "burin/capture/photo.h"
#include "burin/capture/session.h"
#include "burin/scene/blur.h"
#include "burin/scene/scratches.h"
#include "burin/simulate/simulated_camera.h"
#include "tests/calib/photographed_board.h"
#include "tests/temporary_folder.h"

namespace burin {
namespace {

// The board with a lamp of 320 at (69, -319, 452.5), as truth.json has it, and what calibrate makes of its photos.
struct FirstLamp {
  Calibration calibration;
  const Bench& bench() const { return calibration.bench; }
  bool says(const std::string& words) const {
    const auto& findings = calibration.bench.findings;
    const auto has = [&](const Finding& f) { return f.what.find(words) != std::string::npos; };
    return std::any_of(findings.begin(), findings.end(), has) ||
           std::any_of(calibration.findings.begin(), calibration.findings.end(), has);
  }
};

FirstLamp first_lamp_of(Json truth) {
  const TemporaryFolder folder;
  make_photos_smaller(truth);
  simulate(folder.write("truth.json", truth.dump(1)), folder / "photos-of-it");
  const Session session = read_session(folder / "photos-of-it" / "session.json");
  return {calibrate(session, read_board(session.board))};
}

void expect_the_lamp_within(double most_sigma_mm, const Bench& bench) {
  const Eigen::Vector3d position(69, -319, 452.5);
  const Light& lamp = bench.lights[0];
  ASSERT_TRUE(lamp.position_sigma_mm);
  EXPECT_LT(lamp.position_sigma_mm->norm(), most_sigma_mm);
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(lamp.position_mm[i], position[i], 3 * (*lamp.position_sigma_mm)[i]);
}

TEST(FirstLamp, ASoftboxIsNoPoint) {
  Json truth = photographed_board("softbox", 9, "lamp", {60, 60, 0}, 5);
  const Eigen::Vector3d axis = (Eigen::Vector3d(60, 60, 0) - Eigen::Vector3d(69, -319, 452.5)).normalized();
  Json& lamp = truth["lights"][0];
  lamp["axis"] = {axis.x(), axis.y(), axis.z()};
  lamp["falloff_exponent"] = 1;
  lamp["panel_mm"] = {240, 120};
  lamp["turn_deg"] = 30;
  const FirstLamp found = first_lamp_of(truth);
  expect_the_lamp_within(60, found.bench());
  EXPECT_NEAR(found.bench().material.base_alpha / 0.12, 1, 0.05);  // a point's is a fifth rougher
  EXPECT_TRUE(found.says("light lamp is no point"));
}

TEST(FirstLamp, PaperThatShinesIsKnownByItsBlack) {
  Json truth = photographed_board("satin", 9, "lamp", {60, 60, 0}, 5);
  Json& tags = truth["board"]["tags"];
  tags["gloss_f0"] = 0.04;
  tags["gloss_alpha"] = 0.3;
  const FirstLamp found = first_lamp_of(truth);
  expect_the_lamp_within(40, found.bench());
  EXPECT_NEAR(found.bench().paper.f0, 0.04, 0.006);
  EXPECT_NEAR(found.bench().paper.alpha, 0.3, 0.03);
  EXPECT_TRUE(found.says("the tags' paper shines"));
}

// A phone's torch, of which no session says so: at each view the lamp stands elsewhere.
TEST(FirstLamp, ALampOnTheCameraIsOneForEachView) {
  Json truth = photographed_board("torch", 9, "lamp", {60, 60, 0}, 6);
  truth["lights"].clear();
  for (Json& view : truth["views"]) {
    const Json& T = view["T_camera_board"];
    Json place = Json::array();  // 20 mm to the right of the lens and 15 below
    for (int axis = 0; axis < 3; ++axis) {
      double at = 0;
      for (int row = 0; row < 3; ++row)
        at += T[row][axis].get<double>() * ((row == 0 ? 20 : row == 1 ? 15 : 0) - T[row][3].get<double>());
      place.push_back(at);
    }
    const std::string id = "lamp@" + view["view"].get<std::string>();
    truth["lights"].push_back({{"id", id}, {"position_mm", place}, {"intensity", {320000, 320000, 320000}}});
    for (Json& photo : view["photos"]) photo["light"] = id;
  }
  const TemporaryFolder folder;
  make_photos_smaller(truth);
  simulate(folder.write("truth.json", truth.dump(1)), folder / "photos-of-it");
  Session session = read_session(folder / "photos-of-it" / "session.json");
  for (Photo& photo : session.photos) photo.light = "lamp";
  const FirstLamp found{calibrate(session, read_board(session.board))};
  EXPECT_TRUE(found.says("\"lamp\" rides on the camera"));
  ASSERT_EQ(found.bench().lights.size(), truth["views"].size());
  for (const Json& light : truth["lights"]) {
    const Light& lamp = find_light(found.bench(), light["id"].get<std::string>(), "the test");
    ASSERT_TRUE(lamp.position_sigma_mm) << lamp.id;
    for (int i = 0; i < 3; ++i)
      EXPECT_NEAR(lamp.position_mm[i], light["position_mm"][i].get<double>(), 4 * (*lamp.position_sigma_mm)[i])
          << lamp.id;
    EXPECT_LT(lamp.position_sigma_mm->norm(), 150) << lamp.id;
  }
}

// What a phone makes of a picture as it is stored: the dark is brightened by what is seen around, with a blur of its
// own. Not seen where no camera did so.
TEST(LocalTones, AreSeenByPaper) {
  const TemporaryFolder folder;
  Json truth = photographed_board("tones", 9, "lamp", {60, 60, 0}, 5);
  make_photos_smaller(truth);
  simulate(folder.write("truth.json", truth.dump(1)), folder / "photos-of-it");
  const Session session = read_session(folder / "photos-of-it" / "session.json");
  const Board board = read_board(session.board);
  const Sent sent(read_scratches(board.scratches));
  for (const double strength : {0.0, 0.1, 0.4}) {
    Bench bench = calibrate(session, board).bench;
    std::vector<MergedView> photos = merge_session(session);
    float white = 0;
    for (const MergedView& photo : photos)
      for (const float v : photo.value.data) white = std::max(white, v);
    for (MergedView& photo : photos) {
      Image stored = photo.value;
      for (float& v : stored.data) v = std::pow(std::max(0.F, v / white), 1 / 2.2F);
      const Image around = blurred(stored, 0.04 * stored.width);
      for (std::size_t i = 0; i < stored.data.size(); ++i)
        photo.value.data[i] *= static_cast<float>(std::pow(0.5 / (around.data[i] + 0.05), 2.2 * strength));
    }
    std::vector<Finding> findings;
    const std::vector<LightView> views = make_light_views(photos, board, bench, findings);
    const auto tones = find_local_tones(views, gather_light_samples(views, board, bench, sent), bench);
    EXPECT_EQ(tones.has_value(), strength > 0) << strength;
    if (tones) std::printf("tones of %.1f: a power of %.2f +- %.3f\n", strength, tones->power, tones->sigma);
  }
}

// A face that shows next to nothing beside its highlight, which no photo looks into. It was taken for rougher than it
// is, and the lamps for more than a meter aside, so that their light would not be seen in it.
TEST(FirstLamp, AMirrorTurnsNoLampAside) {
  Json truth = photographed_board("mirror", 9, "lamp", {60, 60, 0}, 5);
  truth["material"]["base_alpha"] = 0.0008;
  truth["believed"]["material"]["base_alpha"] = 0.005;
  const Eigen::Vector3d other(-230, 60, 600);
  truth["lights"].push_back(
      {{"id", "other"}, {"position_mm", {other.x(), other.y(), other.z()}}, {"intensity", {400000, 400000, 400000}}});
  for (Json& view : truth["views"]) {
    Json more = view["photos"];
    for (Json& photo : more) {
      photo["light"] = "other";
      photo["file"] = "photos/other-" + photo["file"].get<std::string>().substr(7);
    }
    for (const Json& photo : more) view["photos"].push_back(photo);
  }
  const FirstLamp found = first_lamp_of(truth);
  ASSERT_EQ(found.bench().lights.size(), 2U);
  for (const Light& light : found.bench().lights) {
    const Eigen::Vector3d position = light.id == "other" ? other : Eigen::Vector3d(69, -319, 452.5);
    ASSERT_TRUE(light.position_sigma_mm);
    EXPECT_LT((light.position_mm - position).norm(), 80) << light.id;  // a tag's paper is known to two per cent
    for (int i = 0; i < 3; ++i)
      EXPECT_NEAR(light.position_mm[i], position[i], 4 * (*light.position_sigma_mm)[i]) << light.id;
  }
}

}  // namespace
}  // namespace burin
