// tests/bench/light/probe_figures.cpp - the figures of docs/results/light.md on a room of one's own: a traced room,
// photos of a mirror ball in it (tests/calib/mirror_ball_photos.h), and what burin probe light makes of them.
//
//   burin_probe_figures OUT
//
// writes OUT/light-probe.jpg (room, a photo, what was found) and prints the table, then that of random rooms (some
// minutes).
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <numbers>
#include <random>
#include <string>

#include "burin/base/error.h"
#include "burin/calib/light_probe.h"
#include "burin/pictures/picture.h"
#include "burin/scene/far_light.h"
#include "tests/calib/mirror_ball_photos.h"

namespace {

using namespace burin;
using Eigen::Vector3d;

constexpr double kGain = 0.35;
constexpr int kWidth = 512;

float shown(double light) { return linear_to_srgb(static_cast<float>(1 - std::exp(-0.8 * light))); }

void paste(const Image& from, int x0, int y0, Image& to) {
  for (int y = 0; y < from.height; ++y)
    for (int x = 0; x < from.width; ++x)
      for (int c = 0; c < 3; ++c) to.at(x0 + x, y0 + y, c) = from.at(x, y, c);
}

// Directions above the face and a little below.
template <typename Light>
Image upper_part(const Light& light) {
  Panorama frame;
  frame.radiance = Image(kWidth, kWidth / 2, 3);
  Image out(kWidth, kWidth / 4, 3);
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x) {
      const Vector3d value = light(frame, frame.direction(x + 0.5, y + 0.5));
      for (int c = 0; c < 3; ++c) out.at(x, y, c) = shown(value[c]);
    }
  return out;
}

// How far a lamp is found from its place, degrees, and how much its light is off.
struct LampError {
  double degrees = 0, light = 0;
};
LampError lamp_error(const LightProbe& probe, const Room& room, const RoomLamp& lamp) {
  Panorama frame;
  frame.radiance = probe.radiance;
  Vector3d middle(0, 0, 0);
  double flux = 0;
  for (int y = 0; y < probe.radiance.height; ++y)
    for (int x = 0; x < probe.radiance.width; ++x) {
      const Vector3d d = frame.direction(x + 0.5, y + 0.5);
      if (d.dot(lamp.direction) < std::cos(8 * std::numbers::pi / 180)) continue;
      double above = 0;
      for (int c = 0; c < 3; ++c) above += probe.radiance.at(x, y, c) - room.without_lamps(d)[c];
      middle += above * frame.solid_angle(y) * d;
      flux += above * frame.solid_angle(y);
    }
  const double truth = lamp.solid_angle() * (lamp.radiance - room.without_lamps(lamp.direction)).sum();
  return {std::acos(std::min(1.0, middle.normalized().dot(lamp.direction))) * 180 / std::numbers::pi, flux / truth - 1};
}

void print_lamps(const LightProbe& probe, const Room& room) {
  for (const RoomLamp& lamp : room.lamps) {
    const LampError error = lamp_error(probe, room, lamp);
    std::printf("lamp of %.1f degrees: %.2f degrees off, its light %+.1f %%\n", lamp.half_angle_deg, error.degrees,
                100 * error.light);
  }
}

// Balls of all sizes and reflectances, on the face or above it, on dull metal and on mirrors, smaller photos.
void print_random_rooms(const std::filesystem::path& folder) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> u(0, 1);
  for (int k = 0; k < 14; ++k) {
    BallScene scene;
    scene.lens = {"LENSMODEL_PINHOLE", {1130, 1130, 300, 233}, 600, 466};
    scene.across = 3;
    scene.across_lamp = 8;
    scene.room.lamps[0].half_angle_deg = 2;
    scene.room.lamps[0].radiance = {300, 300, 300};
    scene.radius_mm = 10 + 25 * u(random);
    const double lift = k % 3 == 2 ? 3 + 5 * u(random) : 0;
    scene.center_mm.x() = 70 + 100 * u(random);
    scene.center_mm.y() = 60 + 60 * u(random);
    scene.center_mm.z() = scene.radius_mm + lift;
    scene.face_mirror = k % 2 ? 0.2 + 0.6 * u(random) : 0;
    scene.reflectance.setConstant(0.55 + 0.4 * u(random));
    const double azimuth = 360 * u(random), elevation = 25 + 35 * u(random), distance = 420 + 250 * u(random);
    std::vector<std::pair<double, double>> places = {{azimuth, elevation}};
    places.emplace_back(azimuth + 90 + 60 * u(random), 35 + 25 * u(random));
    if (k % 4) places.emplace_back(azimuth + 240, 45);
    BallExposures how;
    how.gain = kGain;
    how.exposure_s = {1, 0.125, 1.0 / 64, 1.0 / 512};
    Session session;
    int place = 0;
    for (const auto& [a, e] : places)
      photograph(traced(scene, looking_from(scene, a, e, distance)), "random" + std::to_string(place++), how, folder,
                 session);
    LightProbeOptions options;
    options.lens = scene.lens;
    std::printf("radius %.1f mm, %.1f mm up, metal mirrors %.2f, ball %.2f, %zu places: ", scene.radius_mm, lift,
                scene.face_mirror, scene.reflectance.x(), places.size());
    try {
      const LightProbe probe = light_probe(session, scene.board, options);
      LightProbe scaled = probe;
      for (float& value : scaled.radiance.data) value /= static_cast<float>(kGain);
      std::printf("%.0f px wide, places agree %.3f, +- %.2f degrees said; lamps", 2 * probe.places[0].radius_px,
                  probe.agreement, probe.direction_sigma_deg);
      for (const RoomLamp& lamp : scene.room.lamps) std::printf(" %.2f", lamp_error(scaled, scene.room, lamp).degrees);
      std::printf(" degrees off\n");
    } catch (const Error& error) {
      std::printf("%s\n", error.what());
    }
    std::fflush(stdout);
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "burin_probe_figures OUT\n");
    return 2;
  }
  const std::filesystem::path out = argv[1];
  std::filesystem::create_directories(out);
  const BallScene scene;
  Session session;
  BallExposures how;
  how.gain = kGain;
  Image photo;
  int place = 0;
  for (const auto& [azimuth, elevation] : {std::pair(250., 55.), std::pair(10., 40.), std::pair(150., 48.)}) {
    const Image radiance = traced(scene, looking_from(scene, azimuth, elevation, 560));
    if (place == 0) photo = radiance;
    photograph(radiance, "place" + std::to_string(place++), how, out / "photos", session);
  }
  LightProbeOptions options;
  options.lens = scene.lens;
  LightProbe probe = light_probe(session, scene.board, options);
  for (float& value : probe.radiance.data) value /= static_cast<float>(kGain);
  print_lamps(probe, scene.room);
  const Vector3d reflectance = probe.reflectance.cwiseQuotient(scene.reflectance);
  std::printf("reflectance %.3f %.3f %.3f of the true one; middle %.2f mm, radius %.2f mm off; +- %.2f degrees said\n",
              reflectance.x(), reflectance.y(), reflectance.z(), (probe.ball.center_mm - scene.center_mm).norm(),
              probe.ball.radius_mm - scene.radius_mm, probe.direction_sigma_deg);

  Panorama found;
  found.radiance = probe.radiance;
  constexpr int kGap = 6;
  Image picture(2 * kWidth / 3 + kGap + kWidth, 2 * (kWidth / 4) + kGap, 3, 1);
  const Image room = upper_part([&](const Panorama&, const Vector3d& d) { return scene.room(d); });
  const Image again = upper_part([&](const Panorama&, const Vector3d& d) {
    const float* rgb = &found.radiance.data[3 * found.pixel(d)];
    return Vector3d(rgb[0], rgb[1], rgb[2]);
  });
  for (float& value : photo.data) value = shown(value);
  photo = resized(photo, 2 * kWidth / 3, 2 * (kWidth / 4) + kGap);
  paste(photo, 0, 0, picture);
  paste(room, 2 * kWidth / 3 + kGap, 0, picture);
  paste(again, 2 * kWidth / 3 + kGap, kWidth / 4 + kGap, picture);
  write_picture(picture, out / "light-probe.jpg");
  std::printf("wrote %s\n", (out / "light-probe.jpg").c_str());
  print_random_rooms(out / "photos");
}
