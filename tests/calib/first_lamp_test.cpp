// What calibrate takes a lamp for before a glint is looked at, on boards photographed by the point sampler: a softbox
// that is no point, tags on paper that shines. Each moved the lamp by decimeters while it was not known of.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "burin/calib/calibrate.h"
#include "burin/calib/light/lamp.h"
#include "burin/capture/photo.h"
#include "burin/capture/session.h"
#include "burin/capture/simulator/simulated_camera.h"
#include "burin/render/scratches.h"
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

}  // namespace
}  // namespace burin
