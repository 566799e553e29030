// tests/bench/light/color_figures.cpp - the figures of docs/results/light.md on color: boards for lamps of three
// colors, judged by the simulated camera, and what the lamps' places do to the picture.
//
//   burin_color_figures FOLDER OUT [POINTS]
//
// FOLDER holds astronaut.png, chelsea.png and coffee.png; POINTS a pixel, 2048 unless given.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

#include "burin/optimize/design.h"
#include "burin/optimize/design/design_output.h"
#include "burin/optimize/loss/color_metrics.h"
#include "burin/optimize/loss/loss.h"
#include "burin/pictures/picture.h"
#include "burin/scene/look_at.h"
#include "burin/simulate/bench_truth.h"
#include "burin/simulate/point_sampler.h"

namespace {

using namespace burin;
using Eigen::Vector3d;

constexpr int kPixels = 160;  // of the carve area, along each side
constexpr int kFiner = 2;     // photo pixels a pixel of the design
constexpr double kSize_mm = 120, kEdge_mm = 10;
const Vector3d kMiddle(60, 60, 0), kEye_mm(60, -100, 600);

struct Rig {
  Board board;
  Bench bench;
  DesignSpec spec;
};

// Eyes that show a picture each, in color, under three lamps.
Rig rig_of(const std::vector<Vector3d>& eyes, const std::vector<std::filesystem::path>& pictures,
           const std::vector<Vector3d>& lamps, double purity, int scratches) {
  Rig rig;
  rig.board.size_mm = {kSize_mm, kSize_mm};
  rig.board.carve_min_mm = {kEdge_mm, kEdge_mm};
  rig.board.carve_max_mm = {kSize_mm - kEdge_mm, kSize_mm - kEdge_mm};
  rig.board.tool_width_um = 200;
  rig.board.material.alpha = 0.05;
  rig.board.material.depth_um = 14;
  rig.board.material.base_alpha = 0.08;
  rig.board.material.f0 = {0.91, 0.92, 0.92};
  rig.bench.lens = nominal_lens(50, 640, 640);
  rig.bench.material = rig.board.material;
  for (std::size_t k = 0; k < lamps.size(); ++k) {
    Light light;
    light.id = kChannelNames[k];
    light.position_mm = lamps[k];
    light.intensity.setConstant(1e6 * (1 - purity));
    light.intensity[static_cast<Eigen::Index>(k)] = 1e6;
    rig.bench.lights.push_back(light);
  }
  rig.spec.scratches = scratches;
  for (std::size_t k = 0; k < eyes.size(); ++k) {
    View view;
    view.name = "eye-" + std::to_string(k + 1);
    view.T_camera_board = look_at(eyes[k], kMiddle);
    rig.bench.views.push_back(view);
    DesignView wanted;
    wanted.view = view.name;
    wanted.light = "red + green + blue";
    wanted.color = true;
    wanted.target.picture = pictures[k];
    rig.spec.views.push_back(wanted);
  }
  return rig;
}

// The lamp whose half vector with the eye leans so far from the normal, towards that azimuth.
Vector3d lamp_for(double lean_deg, double azimuth_deg) {
  const Vector3d eye = (kEye_mm - kMiddle).normalized();
  const double t = lean_deg * std::numbers::pi / 180, a = azimuth_deg * std::numbers::pi / 180;
  const Vector3d h(std::sin(t) * std::cos(a), std::sin(t) * std::sin(a), std::cos(t));
  return kMiddle + 600 * (2 * h.dot(eye) * h - eye);
}

std::vector<Vector3d> lamps_for(double lean_deg, double apart_deg) {
  // No scratches along the pixels' rows: a photo that is laid on the carve area moves those from row to row.
  constexpr double kTowards_deg = 105;
  return {lamp_for(lean_deg, kTowards_deg), lamp_for(lean_deg, kTowards_deg + apart_deg),
          lamp_for(lean_deg, kTowards_deg - apart_deg)};
}

DesignResult designed(const Rig& rig, int iterations, bool told) {
  DesignOptions options;
  options.pixels = kPixels;
  options.iterations = iterations;
  DesignResult out = design(rig.spec, rig.board, rig.bench, options, {});
  for (const Finding& finding : out.findings)
    if (told) std::printf("    %s\n", sentence(finding).c_str());
  return out;
}

// What the simulated camera sees under all lamps, laid on the carve area's pixels; red, green and blue.
Image photographed(const Rig& rig, const Scratches& scratches, std::size_t eye, int points) {
  BenchTruth truth;
  truth.seed = 7;
  truth.samples = truth.samples_plain = std::max(1, points / (kFiner * kFiner));
  truth.board = truth.believed = rig.board;
  truth.surface = {rig.board.size_mm, Vector3d::Zero()};
  TruthView view;
  view.name = "eye";
  view.T_camera_board = rig.bench.views[eye].T_camera_board;
  const double distance = (view.T_camera_board.inverse().translation() - kMiddle).norm();
  const int side = kFiner * kPixels * 6 / 5;
  const double focal = side / 1.2 / (kSize_mm - 2 * kEdge_mm) * distance, center = 0.5 * (side - 1);
  truth.lens = {"LENSMODEL_PINHOLE", {focal, focal, center, center}, side, side};
  const Carved carved = carved_by(truth, Sent(scratches));
  const Image photo =
      PointSampler(truth, carved).radiance(view, find_light(rig.bench, rig.spec.views[eye].light, "figures"));
  Image out(kPixels, kPixels, 3);
  constexpr int kTaps = 4;
  const double pitch = (kSize_mm - 2 * kEdge_mm) / kPixels;
  for (int y = 0; y < kPixels; ++y)
    for (int x = 0; x < kPixels; ++x)
      for (int tap = 0; tap < kTaps * kTaps; ++tap) {
        const Vector3d p(kEdge_mm + (x + (tap % kTaps + 0.5) / kTaps) * pitch,
                         kSize_mm - kEdge_mm - (y + (tap / kTaps + 0.5) / kTaps) * pitch, 0);
        const Vector3d q = view.T_camera_board * p;
        const auto at = [&](double v) { return std::clamp(static_cast<int>(std::lround(v)), 0, side - 1); };
        const int c = at(focal * q.x() / q.z() + center), r = at(focal * q.y() / q.z() + center);
        for (int ch = 0; ch < 3; ++ch) out.at(x, y, ch) += photo.at(c, r, ch) / (kTaps * kTaps);
      }
  return out;
}

// The photo at the white balance that the design says, at the exposure that suits it best.
Image shown_photo(Image radiance, const DesignedView& v) {
  for (std::size_t i = 0; i < radiance.data.size(); ++i)
    radiance.data[i] *= static_cast<float>(v.color->white_gain[i % 3]);
  return shown_picture(radiance, color_best_exposure(radiance, v.target, v.best_exposure));
}

void print_quality(const char* what, const Image& shown, const Image& target) {
  const ColorQuality q = color_quality(shown, target);
  std::printf(" %s %.1f | %.1f %.1f %.1f | %.1f | %.2f |", what, color_psnr_db(shown, target), q.channel_psnr_db[0],
              q.channel_psnr_db[1], q.channel_psnr_db[2], q.luminance_psnr_db, color_ssim(shown, target));
}

// Designs a board, judges it, and adds its pictures as rows: target, promised, photographed.
void judge(const char* name, const Rig& rig, int iterations, int points, std::vector<std::vector<Image>>& rows) {
  const DesignResult result = designed(rig, iterations, true);
  for (std::size_t k = 0; k < result.views.size(); ++k) {
    const DesignedView& v = result.views[k];
    const Image photo = shown_photo(photographed(rig, result.scratches, k, points), v);
    std::printf("| %s, %s |", name, rig.spec.views[k].target.picture.stem().c_str());
    print_quality("promised", v.shown, v.target);
    print_quality("photographed", photo, v.target);
    std::printf("\n");
    std::fflush(stdout);
    rows.push_back({v.target, v.shown, photo});
  }
}

void run(const std::filesystem::path& from, const std::filesystem::path& out, int points) {
  std::filesystem::create_directories(out);
  const std::filesystem::path astronaut = from / "astronaut.png", chelsea = from / "chelsea.png",
                              coffee = from / "coffee.png";
  std::printf("| lamps' half vectors | RGB dB | red green blue | luminance | SSIM |\n");
  for (const auto& [lean, apart] :
       {std::pair{24, 5}, {24, 10}, {24, 20}, {24, 30}, {24, 45}, {24, 60}, {12, 60}, {16, 60}, {20, 60}, {28, 60}}) {
    const Rig rig = rig_of({kEye_mm}, {coffee}, lamps_for(lean, apart), 1, 6000);
    const DesignResult result = designed(rig, 40, false);
    std::printf("| lean %d, %d apart |", lean, apart);
    print_quality("", result.views[0].shown, result.views[0].target);
    std::printf(" the face allows %.1f\n", result.views[0].achievable_psnr_db);
    std::fflush(stdout);
  }
  std::vector<std::vector<Image>> rows;
  judge("one view", rig_of({kEye_mm}, {astronaut}, lamps_for(28, 60), 1, 12000), 60, points, rows);
  judge("one view", rig_of({kEye_mm}, {chelsea}, lamps_for(28, 60), 1, 12000), 60, points, rows);
  judge("lamps three quarters pure", rig_of({kEye_mm}, {chelsea}, lamps_for(28, 60), 0.75, 12000), 60, points, rows);
  judge("three views",
        rig_of({{-21, 258, 560}, {-33, -8, 589}, {229, 178, 563}}, {astronaut, chelsea, coffee},
               {{328, -407, 265}, {-137, -410, 317}, {522, 42, 383}}, 1, 30000),
        60, points, rows);
  std::vector<std::vector<Image>> sheet;  // two boards' pictures beside each other
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (k % 2 == 0) sheet.emplace_back();
    sheet.back().insert(sheet.back().end(), rows[k].begin(), rows[k].end());
  }
  write_picture(tiled(sheet, 4), out / "color.jpg");
}

}  // namespace

int main(int count, char** words) {
  if (count < 3) {
    std::printf("give the folder with the pictures and one for what is made\n");
    return 2;
  }
  try {
    run(words[1], words[2], count > 3 ? std::atoi(words[3]) : 2048);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
  return 0;
}
