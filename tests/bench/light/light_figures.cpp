// tests/bench/light/light_figures.cpp - the figures of docs/results/light.md: one board designed for its lamp, seen
// under that lamp, under sun and sky, and in a room with a window; and boards designed for these. Each is judged by the
// simulated camera, which draws points and directions and knows none of the renderer's tables.
//
//   burin_light_figures FOLDER OUT [POINTS [SCRATCHES [CASE ...]]]
//
// FOLDER holds the two pictures, camera.png and astronaut.png; POINTS a pixel, 2048 unless given; SCRATCHES of a board,
// 4000 unless given; cases: sun, sun-aside, room, room-aside, all of them unless given.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "burin/base/error.h"
#include "burin/optimize/design.h"
#include "burin/optimize/design/design_output.h"
#include "burin/optimize/loss/picture_metrics.h"
#include "burin/pictures/picture.h"
#include "burin/scene/far_light.h"
#include "burin/scene/look_at.h"
#include "burin/simulate/bench_truth.h"
#include "burin/simulate/point_sampler.h"

namespace {

using namespace burin;
using Eigen::Vector3d;

constexpr int kPixels = 160;  // of the carve area, along each side
constexpr int kFiner = 2;     // photo pixels a pixel of the design
constexpr double kSize_mm = 120, kEdge_mm = 10;
const Vector3d kMiddle(60, 60, 0), kLamp_mm(60, 490, 560);

/// What light is turned about that comes from aside of the lamp: at right angles to the lamp's direction.
const Vector3d kAside(0, 560, -430);

/// The world's up: the board leans back by 30 degrees.
const Vector3d kUp = Vector3d(0, std::cos(std::numbers::pi / 6), std::sin(std::numbers::pi / 6));

Image painted(const std::function<Vector3d(const Vector3d&)>& radiance) {
  Panorama frame;
  frame.radiance = Image(512, 256, 3);
  Image out = frame.radiance;
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x) {
      const Vector3d seen = radiance(frame.direction(x + 0.5, y + 0.5));
      for (int c = 0; c < 3; ++c) out.at(x, y, c) = static_cast<float>(seen[c]);
    }
  return out;
}

/// The CIE's standard clear sky (CIE S 011/E:2003, ISO 15469:2004, type 12), and ground of a fifth of its brightness.
double clear_sky(const Vector3d& to, const Vector3d& sun) {
  constexpr double a = -1, b = -0.32, c = 10, d = -3, e = 0.45;
  const double height = to.dot(kUp);
  if (height <= 0) return 0.08;
  const auto indicatrix = [&](double chi) {
    return 1 + c * (std::exp(d * chi) - std::exp(d * std::numbers::pi / 2)) + e * std::cos(chi) * std::cos(chi);
  };
  const double chi = std::acos(std::clamp(to.dot(sun), -1.0, 1.0)),
               zenith = std::acos(std::clamp(sun.dot(kUp), -1., 1.));
  const double gradation = 1 + a * std::exp(b / std::max(0.01, height));
  return indicatrix(chi) * gradation / (indicatrix(zenith) * (1 + a * std::exp(b)));
}

/// The sun there, and the sky about it, with 4.6 times as much light on the face from the sun.
Light sun_and_sky(const Vector3d& towards) {
  const Vector3d sun = towards.normalized();
  const auto sky = make_panorama(
      painted([&](const Vector3d& to) -> Vector3d { return clear_sky(to, sun) * Vector3d(0.85, 1, 1.25); }), {}, "sky");
  const double from_sky = irradiance(*sky, Vector3d::UnitZ()).mean();
  Light out = sun_light(sun, 4.6 * from_sky / sun.z() * Vector3d::Ones());
  out.id = "sun";
  Light around = surroundings_light(sky);
  around.id = "sky";
  out.also.push_back(around);
  return out;
}

/// A room: a window of 18 by 24 degrees with a cross of bars, bright walls, a brighter ceiling, a dark floor.
Light room_with_window(const Vector3d& towards) {
  const Vector3d middle = towards.normalized(), right = kUp.cross(middle).normalized(), up = middle.cross(right);
  Light out = surroundings_light(make_panorama(painted([&](const Vector3d& to) -> Vector3d {
                                                 const double ahead = to.dot(middle);
                                                 const double x = to.dot(right) / ahead, y = to.dot(up) / ahead;
                                                 if (ahead > 0 && std::abs(x) < 0.158 && std::abs(y) < 0.213 &&
                                                     std::abs(x) > 0.008 && std::abs(y) > 0.008)
                                                   return (8 + 8 * y) * Vector3d(0.9, 1, 1.15);
                                                 const double height = to.dot(kUp);
                                                 const double wall = height > 0.6 ? 0.22 : height < -0.5 ? 0.04 : 0.1;
                                                 return wall * Vector3d(1.05, 1, 0.9);
                                               }),
                                               {}, "room"));
  out.id = "room";
  return out;
}

Vector3d turned(const Vector3d& about, const Vector3d& v, double degrees) {
  return Eigen::AngleAxisd(degrees * std::numbers::pi / 180, about.normalized()) * v;
}

struct Rig {
  Board board;
  std::vector<Vector3d> eyes;
  std::filesystem::path pictures;
};

Rig the_rig(const std::filesystem::path& pictures) {
  Rig rig;
  rig.board.size_mm = {kSize_mm, kSize_mm};
  rig.board.carve_min_mm = {kEdge_mm, kEdge_mm};
  rig.board.carve_max_mm = {kSize_mm - kEdge_mm, kSize_mm - kEdge_mm};
  rig.board.material.alpha = 0.06;
  rig.board.material.depth_um = 14;
  rig.board.material.base_alpha = 0.15;
  rig.board.material.f0 = {0.91, 0.92, 0.92};
  rig.eyes = {{-170, -50, 520}, {290, -50, 520}};
  rig.pictures = pictures;
  return rig;
}

Bench bench_under(const Rig& rig, const Light& light) {
  Bench bench;
  bench.lens = nominal_lens(50, 640, 640);
  for (std::size_t k = 0; k < rig.eyes.size(); ++k) {
    View view;
    view.name = k == 0 ? "left" : "right";
    view.T_camera_board = look_at(rig.eyes[k], kMiddle);
    bench.views.push_back(view);
  }
  bench.lights = {light};
  bench.lights.front().also.clear();
  for (const Light& other : light.also) bench.lights.push_back(other);
  bench.material = rig.board.material;
  return bench;
}

DesignResult designed_for(const Rig& rig, const Light& light, int scratches) {
  const Bench bench = bench_under(rig, light);
  DesignSpec spec;
  spec.scratches = scratches;
  std::vector<std::string> names;
  for (const Light& l : bench.lights) names.push_back(l.id);
  for (std::size_t k = 0; k < rig.eyes.size(); ++k) {
    DesignView view;
    view.view = bench.views[k].name;
    view.light = joined_lights(names);
    view.target.picture = rig.pictures / (k == 0 ? "camera.png" : "astronaut.png");
    spec.views.push_back(view);
  }
  DesignOptions options;
  options.pixels = kPixels;
  DesignResult out = design(spec, rig.board, bench, options, {});
  for (const Finding& finding : out.findings) std::printf("    %s\n", sentence(finding).c_str());
  return out;
}

// What the simulated camera sees, laid on the carve area's pixels.
Image photographed(const Rig& rig, const Scratches& scratches, std::size_t eye, const Light& light, int points) {
  BenchTruth truth;
  truth.seed = 7;
  truth.samples = truth.samples_plain = std::max(1, points / (kFiner * kFiner));
  truth.lamp_samples = 24;
  truth.board = truth.believed = rig.board;
  truth.surface = {rig.board.size_mm, Vector3d::Zero()};
  TruthView view;
  view.name = "eye";
  view.T_camera_board = look_at(rig.eyes[eye], kMiddle);
  const int side = kFiner * kPixels * 6 / 5;
  const double focal = side / 1.2 / (kSize_mm - 2 * kEdge_mm) * (rig.eyes[eye] - kMiddle).norm();
  truth.lens = {"LENSMODEL_PINHOLE", {focal, focal, 0.5 * (side - 1), 0.5 * (side - 1)}, side, side};
  const Carved carved = carved_by(truth, Sent(scratches));
  const Image photo = PointSampler(truth, carved).radiance(view, light);
  Image out(kPixels, kPixels, 1);
  constexpr int kTaps = 4;
  const double pitch = (kSize_mm - 2 * kEdge_mm) / kPixels;
  for (int y = 0; y < kPixels; ++y)
    for (int x = 0; x < kPixels; ++x) {
      double sum = 0;
      for (int j = 0; j < kTaps; ++j)
        for (int i = 0; i < kTaps; ++i) {
          const Vector3d p(kEdge_mm + (x + (i + 0.5) / kTaps) * pitch,
                           kSize_mm - kEdge_mm - (y + (j + 0.5) / kTaps) * pitch, 0);
          const Vector3d q = view.T_camera_board * p;
          const int c = std::clamp(static_cast<int>(std::lround(focal * q.x() / q.z() + 0.5 * (side - 1))), 0,
                                   side - 1),
                    r = std::clamp(static_cast<int>(std::lround(focal * q.y() / q.z() + 0.5 * (side - 1))), 0,
                                   side - 1);
          sum += photo.at(c, r, 0) + photo.at(c, r, 1) + photo.at(c, r, 2);
        }
      out.at(x, y) = static_cast<float>(sum / (3 * kTaps * kTaps));
    }
  return out;
}

double quantile(Image image, double part) {
  const auto at = image.data.begin() + static_cast<std::ptrdiff_t>(part * static_cast<double>(image.data.size() - 1));
  std::nth_element(image.data.begin(), at, image.data.end());
  return *at;
}

struct Judged {
  std::vector<Image> pictures;
};

Judged judge(const std::string& what, const Rig& rig, const DesignResult& design, const Light& light, int points) {
  Judged out;
  std::printf("| %s |", what.c_str());
  for (std::size_t k = 0; k < rig.eyes.size(); ++k) {
    const Image radiance = photographed(rig, design.scratches, k, light, points);
    const Image& target = design.views[k].target;
    double sum = 0, wanted = 0;
    for (std::size_t i = 0; i < radiance.data.size(); ++i) {
      sum += radiance.data[i];
      wanted += std::pow(target.data[i], 2.2);
    }
    const double exposure = best_exposure(radiance, target, wanted / sum);
    Image shown = radiance;
    for (float& v : shown.data) v = static_cast<float>(std::pow(std::clamp(exposure * v, 0.0, 1.0), 1 / 2.2));
    std::printf(" %.1f | %.2f | %.2f | %.0f : 1 |", psnr_db(shown, target), ssim(shown, target),
                correlation(shown, target), quantile(radiance, 0.99) / quantile(radiance, 0.01));
    out.pictures.push_back(shown);
  }
  std::printf("\n");
  std::fflush(stdout);
  return out;
}

void run(const std::filesystem::path& pictures, const std::filesystem::path& out, int points, int scratches,
         const std::vector<std::string>& wanted) {
  std::filesystem::create_directories(out);
  const Rig rig = the_rig(pictures);
  Light lamp;
  lamp.position_mm = kLamp_mm;
  lamp.intensity.setConstant(1e6);
  const Vector3d there = kLamp_mm - kMiddle;
  struct Case {
    std::string name, file;
    Light light;
  };
  std::vector<Case> cases{
      {"its lamp", "lamp", lamp},
      {"sun where the lamp was, sky", "sun", sun_and_sky(there)},
      {"sun 11 degrees off, sky", "sun-aside", sun_and_sky(turned(kAside, there, 11))},
      {"room, window where the lamp was", "room", room_with_window(there)},
      {"room, window 26 degrees off", "room-aside", room_with_window(turned(kAside, there, 26))},
  };
  std::erase_if(cases, [&](const Case& c) {
    return c.file != "lamp" && !wanted.empty() && std::find(wanted.begin(), wanted.end(), c.file) == wanted.end();
  });
  for (const Case& c : cases)
    std::printf("%s: %.1f degrees from the lamp\n", c.file.c_str(),
                std::acos(std::min(
                    1.0, there.normalized().dot(
                             (c.light.position_mm - (c.light.is_near() ? kMiddle : Vector3d(0, 0, 0))).normalized()))) *
                    180 / std::numbers::pi);
  const DesignResult of_lamp = designed_for(rig, lamp, scratches);
  for (const DesignedView& v : of_lamp.views) std::printf("    promised %s %.1f dB\n", v.view.c_str(), v.psnr_db);
  std::vector<std::vector<Image>> shown(2), again(2);
  std::printf("| the board of the lamp under | PSNR | SSIM | corr. | contrast | PSNR | SSIM | corr. | contrast |\n");
  for (const Case& c : cases) {
    const Judged judged = judge(c.name, rig, of_lamp, c.light, points);
    for (int k = 0; k < 2; ++k) shown[k].push_back(judged.pictures[k]);
  }
  std::printf("| a board of its own for |\n");
  for (std::size_t i = 1; i < cases.size(); ++i) {
    const DesignResult own = designed_for(rig, cases[i].light, scratches);
    for (const DesignedView& v : own.views)
      std::printf("    promised %s %.1f dB, the face allows %.1f dB\n", v.view.c_str(), v.psnr_db,
                  v.achievable_psnr_db);
    std::fflush(stdout);
    const Judged judged = judge(cases[i].name, rig, own, cases[i].light, points);
    for (int k = 0; k < 2; ++k) again[k].push_back(judged.pictures[k]);
  }
  for (int k = 0; k < 2; ++k) again[k].insert(again[k].begin(), of_lamp.views[k].target);
  for (int k = 0; k < 2; ++k) again[k].resize(shown[k].size());
  write_picture(tiled({shown[0], again[0], shown[1], again[1]}, 4), out / "light.png");
}

}  // namespace

int main(int count, char** words) {
  if (count < 3) {
    std::printf("give the folder with the pictures and one for what is made\n");
    return 2;
  }
  try {
    run(words[1], words[2], count > 3 ? std::atoi(words[3]) : 2048, count > 4 ? std::atoi(words[4]) : 4000,
        std::vector<std::string>(words + std::min(count, 5), words + count));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
  return 0;
}
