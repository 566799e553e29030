// Proves: photos of a mirror ball on the tagged board, traced ray by ray in a room that is known, become that room:
// lamps where they are (0.5 degrees), their light and all light as it is (3 %), the ball's reflectance by the paper,
// the photographer gone where another place looks past him. And that what is no ball, hidden, clipped or without tags
// is refused in words.
#include "burin/calib/light_probe.h"

#include <gmock/gmock.h>

#include <memory>
#include <random>

#include "burin/base/error.h"
#include "burin/calib/light/probe/fill_unseen.h"
#include "burin/calib/light/probe/probe_session.h"
#include "burin/scene/far_light.h"
#include "tests/calib/mirror_ball_photos.h"
#include "tests/temporary_folder.h"

namespace burin {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr double kDeg = 180 / std::numbers::pi;

// Photographs a scene from places given by azimuth and elevation.
Session photographed(const BallScene& scene, const std::vector<std::pair<double, double>>& places,
                     const BallExposures& how, const TemporaryFolder& folder, double distance_mm = 560) {
  Session session;
  int k = 0;
  for (const auto& [azimuth, elevation] : places)
    photograph(traced(scene, looking_from(scene, azimuth, elevation, distance_mm)), "place" + std::to_string(k++), how,
               folder.path(), session);
  return session;
}

// A small scene, one place, for what is refused.
BallScene small_scene() {
  BallScene scene;
  scene.lens = {"LENSMODEL_PINHOLE", {850, 850, 225, 175}, 450, 350};
  scene.across = 3;
  scene.across_lamp = 4;
  scene.room.lamps[0].half_angle_deg = 2;
  scene.room.lamps[0].radiance = {300, 300, 300};
  scene.has_photographer = false;
  return scene;
}

std::string refusal(const BallScene& scene, const BallExposures& how = {},
                    const std::vector<std::pair<double, double>>& places = {{250, 50}}) {
  const TemporaryFolder folder;
  LightProbeOptions options;
  options.lens = scene.lens;
  try {
    light_probe(photographed(scene, places, how, folder), scene.board, options);
  } catch (const Error& error) {
    return error.what();
  }
  return "nothing was refused";
}

// The middle and the irradiance of what a panorama shows within so many degrees of a lamp, above its surroundings.
struct LampSeen {
  Eigen::Vector3d direction{0, 0, 0};
  double flux = 0;
};
LampSeen lamp_in(const LightProbe& probe, const Room& room, const RoomLamp& lamp, double within_deg) {
  Panorama frame;
  frame.radiance = probe.radiance;
  LampSeen out;
  for (int y = 0; y < probe.radiance.height; ++y)
    for (int x = 0; x < probe.radiance.width; ++x) {
      const Eigen::Vector3d d = frame.direction(x + 0.5, y + 0.5);
      if (d.dot(lamp.direction) < std::cos(within_deg / kDeg)) continue;
      double above = 0;
      for (int c = 0; c < 3; ++c) above += probe.radiance.at(x, y, c) - room.without_lamps(d)[c];
      out.direction += above * frame.solid_angle(y) * d;
      out.flux += above * frame.solid_angle(y);
    }
  out.direction.normalize();
  return out;
}

TEST(LightProbe, MirrorNormalIsWhereTheRayIsReflected) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> u(-1, 1);
  int shown = 0;
  for (int k = 0; k < 300; ++k) {
    const MirrorBall ball{{30 * u(random), 20 * u(random), 12}, 12};
    const Eigen::Vector3d eye =
        ball.center_mm + (60 + 300 * (1 + u(random))) * direction_of(180 * u(random), 80 * u(random));
    const Eigen::Vector3d to = direction_of(180 * u(random), 90 * u(random));
    const auto normal = mirror_normal(ball, eye, to);
    if (!normal) continue;
    ++shown;
    const Eigen::Vector3d at = ball.center_mm + ball.radius_mm * *normal, ray = (at - eye).normalized();
    EXPECT_LT(ray.dot(*normal), 0);
    EXPECT_NEAR((ray - 2 * ray.dot(*normal) * *normal - to).norm(), 0, 1e-8);
  }
  EXPECT_GT(shown, 250);
}

TEST(LightProbe, WhatIsNotSeenIsFilledSmoothly) {
  Image picture(64, 32, 3);
  std::vector<std::uint8_t> known(64 * 32, 1);
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 64; ++x) {
      for (int c = 0; c < 3; ++c) picture.at(x, y, c) = 2.0F + static_cast<float>(c);
      if (y > 16 && (x < 9 || x > 55)) {  // across the seam
        known[static_cast<std::size_t>(y) * 64 + x] = 0;
        for (int c = 0; c < 3; ++c) picture.at(x, y, c) = 1e6F;
      }
    }
  fill_unseen(picture, known);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(picture.at(0, 25, c), 2 + c, 1e-4);
  picture.at(10, 20, 0) = 1e5F;  // a lamp beside the hole lights it little
  fill_unseen(picture, known);
  EXPECT_LT(picture.at(2, 20, 0), 200);
}

// The shortest exposures of a bracket hold the sun and no tag: they belong to the place beside them in time.
TEST(LightProbe, DarkPhotosBelongToThePlaceBesideThem) {
  FolderSession folder;
  const auto add = [&](const char* view, double time_s, bool tags) {
    Photo photo;
    photo.view = view;
    photo.exposure_s = 0.1;
    folder.session.photos.push_back(photo);
    Exif exif;
    exif.time_s = time_s;
    folder.exif.push_back(exif);
    PhotoLook look;
    if (tags) look.tags.resize(4);
    folder.looks.push_back(look);
  };
  add("v00", 0, true);
  add("v00", 2, true);
  add("v01", 4, false);    // two seconds after one place
  add("v02", 100, false);  // five before the other
  add("v03", 105, true);
  add("v04", 400, false);  // nobody knows
  join_dark_views(folder);
  std::string views;
  for (const Photo& photo : folder.session.photos) views += photo.view + " ";
  EXPECT_EQ(views, "v00 v00 v00 v03 v03 v04 ");
}

void expect_ball(const BallScene& scene, const LightProbe& probe) {
  EXPECT_LT((probe.ball.center_mm - scene.center_mm).norm(), 0.1);
  EXPECT_NEAR(probe.ball.radius_mm, scene.radius_mm, 0.08);
  EXPECT_EQ(probe.places.size(), 3U);
  for (const ProbePlace& place : probe.places) EXPECT_GT(place.outline_found, 0.6) << place.view;
}

void expect_lamps(const BallScene& scene, const LightProbe& probe) {
  for (const RoomLamp& lamp : scene.room.lamps) {
    const LampSeen seen = lamp_in(probe, scene.room, lamp, 8);
    EXPECT_LT(std::acos(std::min(1.0, seen.direction.dot(lamp.direction))) * kDeg, 0.5);
    const double flux = lamp.solid_angle() * (lamp.radiance - scene.room.without_lamps(lamp.direction)).sum();
    EXPECT_NEAR(seen.flux / flux, 1, 0.03);
  }
  EXPECT_LT(std::acos(std::min(1.0, probe.brightest.direction.dot(scene.room.lamps[0].direction))) * kDeg, 0.5);
}

void expect_irradiance(const BallScene& scene, const LightProbe& probe) {
  Panorama panorama;
  panorama.radiance = probe.radiance;
  for (std::size_t y = panorama.radiance.height / 2; y < static_cast<std::size_t>(panorama.radiance.height); ++y)
    for (int x = 0; x < 3 * panorama.radiance.width; ++x)
      panorama.radiance.data[3 * y * panorama.radiance.width + x] = 0;
  for (const Eigen::Vector3d& normal :
       {direction_of(0, 90), direction_of(30, 65), direction_of(150, 65), direction_of(270, 60)}) {
    const Eigen::Vector3d truth = scene.room.irradiance(normal), found = irradiance(panorama, normal);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(found[c] / truth[c], 1, 0.03) << normal.transpose();
  }
}

void expect_reflectance(const BallScene& scene, const LightProbe& probe) {
  EXPECT_TRUE(probe.reflectance_by_paper);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(probe.reflectance[c] / scene.reflectance[c], 1, 0.03);
}

void expect_nobody(const BallScene& scene, const LightProbe& probe) {
  EXPECT_GT(probe.seen_share, 0.97);
  EXPECT_LT(probe.photographer_share, 0.001);
  Panorama panorama;
  panorama.radiance = probe.radiance;
  for (const auto& [azimuth, elevation] : {std::pair(250., 55.), std::pair(10., 40.), std::pair(150., 48.)}) {
    const Eigen::Vector3d d = direction_of(azimuth, elevation), truth = scene.room.without_lamps(d);
    const std::size_t pixel = panorama.pixel(d);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(panorama.radiance.data[3 * pixel + c] / truth[c], 1, 0.06);
  }
}

// The whole: three places, five exposures, a lens that bends, a person.
TEST(TracedRoom, IsMeasured) {
  const BallScene scene;
  const TemporaryFolder folder;
  BallExposures how;
  how.gain = 0.35;
  LightProbeOptions options;
  options.lens = scene.lens;
  LightProbe probe =
      light_probe(photographed(scene, {{250, 55}, {10, 40}, {150, 48}}, how, folder), scene.board, options);
  // In units of the room: what the camera's own gain makes of it is not the probe's business.
  for (float& value : probe.radiance.data) value /= 0.35F;
  expect_ball(scene, probe);
  expect_lamps(scene, probe);
  expect_irradiance(scene, probe);
  expect_reflectance(scene, probe);
  expect_nobody(scene, probe);
}

TEST(LightProbe, ABallOnANutBeforeShinyMetalIsFound) {
  BallScene scene = small_scene();
  scene.center_mm = {75, 105, 28.9};
  scene.radius_mm = 21.7;
  scene.face_mirror = 0.36;
  BallExposures how;
  how.gain = 0.35;
  how.exposure_s = {1, 0.125, 1.0 / 64};
  LightProbeOptions options;
  options.lens = scene.lens;
  const TemporaryFolder folder;
  const LightProbe probe =
      light_probe(photographed(scene, {{250, 50}, {20, 40}, {130, 45}}, how, folder, 480), scene.board, options);
  EXPECT_LT((probe.ball.center_mm - scene.center_mm).norm(), 0.5);
  EXPECT_NEAR(probe.ball.radius_mm, scene.radius_mm, 0.3);
  EXPECT_GT(probe.agreement, 0.85);
  for (const RoomLamp& lamp : scene.room.lamps) {  // a pixel spans 3 degrees
    const LampSeen seen = lamp_in(probe, scene.room, lamp, 9);
    EXPECT_LT(std::acos(std::min(1.0, seen.direction.dot(lamp.direction))) * kDeg, 1.5);
  }
}

// A little oval, which its outline alone hardly tells: no two places show the same room.
TEST(LightProbe, ASlightEggFromThreePlacesIsRefused) {
  BallScene scene = small_scene();
  scene.stretch = {1.04, 0.98, 1};
  BallExposures how;
  how.gain = 0.35;
  how.exposure_s = {1, 0.125, 1.0 / 64};
  EXPECT_THAT(refusal(scene, how, {{250, 50}, {10, 45}, {130, 40}}), HasSubstr("not round"));
}

TEST(LightProbe, OneExposureWithAClippedLampIsRefused) {
  BallExposures how;
  how.gain = 0.35;
  how.exposure_s = {1};
  EXPECT_THAT(refusal(small_scene(), how),
              AllOf(HasSubstr("place0-0.tif"), HasSubstr("clipped"), HasSubstr("bracket")));
}

TEST(LightProbe, ClippedInEveryExposureIsRefused) {
  BallExposures how;
  how.gain = 0.35;
  how.exposure_s = {1, 0.5};
  EXPECT_THAT(refusal(small_scene(), how), AllOf(HasSubstr("clipped"), HasSubstr("shortest exposure")));
}

TEST(LightProbe, AnEggIsRefused) {
  BallScene scene = small_scene();
  scene.stretch = {1.06, 0.97, 1};
  BallExposures how;
  how.gain = 0.35;
  EXPECT_THAT(refusal(scene, how), HasSubstr("not round"));
}

TEST(LightProbe, HalfAHiddenBallIsRefused) {
  BallScene scene = small_scene();
  scene.has_card = true;
  BallExposures how;
  how.gain = 0.35;
  EXPECT_THAT(refusal(scene, how), HasSubstr("half hidden"));
}

TEST(LightProbe, NoBallIsRefused) {
  BallScene scene = small_scene();
  scene.has_ball = false;
  BallExposures how;
  how.gain = 0.35;
  how.exposure_s = {1, 0.125};
  EXPECT_THAT(refusal(scene, how), HasSubstr("ball"));
}

TEST(LightProbe, TooFewTagsAreRefused) {
  BallScene scene = small_scene();
  scene.covered_tags = {1, 2, 3, 4, 5, 6, 7, 8};
  BallExposures how;
  how.gain = 0.35;
  EXPECT_THAT(refusal(scene, how), AllOf(HasSubstr("tag"), HasSubstr("photograph")));
}

TEST(LightProbe, LensOfOtherPhotosIsRefused) {
  BallScene scene = small_scene();
  BallExposures how;
  how.exposure_s = {1};
  const TemporaryFolder folder;
  const Session session = photographed(scene, {{250, 50}}, how, folder);
  LightProbeOptions options;
  options.lens = BallScene().lens;
  EXPECT_THROW(light_probe(session, scene.board, options), Error);
}

}  // namespace
}  // namespace burin
