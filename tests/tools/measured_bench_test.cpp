// Proves that a design for a measured bench is what comes out of the workshop: on a bench with a depth field of 8 %,
// wear of 4 %, crossings where the groove carved last rules, and a machine map of 0.4 %, a board is designed, its tool
// path made, carved and photographed (by the simulator's point sampler, which shares no formula of light with the
// design), and every photo comes within 0.5 dB of what the design promised. The log says what it costs to ignore each
// of these.
//
// BURIN_FULL_SIZE=1 makes it the size of samples/small-bench (10,000 scratches, 256 pixels); some minutes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "burin/base/files/json_file.h"
#include "burin/capture/photo.h"
#include "burin/capture/session.h"
#include "burin/optimize/design.h"
#include "burin/optimize/loss/picture_metrics.h"
#include "burin/optimize/toolpath.h"
#include "burin/simulate/bench_truth.h"
#include "burin/simulate/simulated_camera.h"
#include "tests/places.h"
#include "tests/temporary_folder.h"
#include "tools/report/rectified.h"

namespace burin {
namespace {

struct Size {
  int scratches, pixels, iterations, camera_px, samples;
};

Size size_asked_for() {
  if (std::getenv("BURIN_FULL_SIZE") != nullptr) return {10000, 256, 100, 1536, 100};
  return {1800, 100, 40, 400, 576};
}

constexpr double kBoard_mm = 60, kEdge_mm = 10;

// A camera that looks at the board's middle with the board's y upwards.
Json pose(const Eigen::Vector3d& eye) {
  const Eigen::Vector3d forward = (Eigen::Vector3d(kBoard_mm / 2, kBoard_mm / 2, 0) - eye).normalized();
  const Eigen::Vector3d right = forward.cross(Eigen::Vector3d::UnitY()).normalized(), down = forward.cross(right);
  Json rows = Json::array();
  for (const Eigen::Vector3d& axis : {right, down, forward})
    rows.push_back({axis.x(), axis.y(), axis.z(), -axis.dot(eye)});
  rows.push_back({0, 0, 0, 1});
  return rows;
}

// Where the camera must stand for the board's middle to have a half vector of this lean and azimuth.
Eigen::Vector3d eye_for(const Eigen::Vector3d& lamp, double lean_deg, double azimuth_deg) {
  const double t = lean_deg * std::numbers::pi / 180, a = azimuth_deg * std::numbers::pi / 180;
  const Eigen::Vector3d middle(kBoard_mm / 2, kBoard_mm / 2, 0),
      h(std::sin(t) * std::cos(a), std::sin(t) * std::sin(a), std::cos(t)), wi = (lamp - middle).normalized();
  return middle + 500 * (2 * wi.dot(h) * h - wi);
}

// The bench as it is. Half vectors lean 18 to 19 degrees, grooves reach 21: a few percent of depth are seen.
Json truth_of(const Size& size) {
  const Eigen::Vector3d lamp(kBoard_mm / 2, -315, 450);
  Json truth = Json::parse(R"({
    "format": "burin/rig-truth", "version": 1, "name": "measured", "seed": 11, "samples_plain": 4, "overlap": "last",
    "board": { "size_mm": [60, 60], "carve_mm": [[10, 10], [50, 50]], "tool": { "width_um": 300 },
               "tags": { "family": "tag36h11", "z_mm": 0, "quiet_mm": 0.5,
                         "list": [ { "id": 3, "center_mm": [5, 5], "size_mm": 6 } ] } },
    "material": { "alpha": 0.05, "depth_um": 5.2, "base_alpha": 0.1, "f0": [0.9, 0.9, 0.9],
                  "depth_gradient": [0.08, -0.05], "wear": 0.04 },
    "machine": { "affine": [[1.004, 0.0006, 0.08], [-0.0005, 0.997, -0.11]] },
    "sensor": { "channels": 1, "bits": 16, "encoding": "linear", "gain": 20000, "full_well_e": 200000,
                "read_noise_e": 3 }
  })");
  truth["samples"] = size.samples;
  truth["scratches"] = {{"random", {{"count", 10}, {"length_mm", {2, 3}}, {"seed", 1}}}};
  const double focal_px = 500.0 / kBoard_mm * size.camera_px * 0.98, center = (size.camera_px - 1) / 2.0;
  truth["camera"] = {{"lensmodel", "LENSMODEL_PINHOLE"},
                     {"imagersize", {size.camera_px, size.camera_px}},
                     {"intrinsics", {focal_px, focal_px, center, center}}};
  truth["lights"] = Json::array(
      {{{"id", "lamp"}, {"position_mm", {lamp.x(), lamp.y(), lamp.z()}}, {"intensity", {300000, 300000, 300000}}}});
  truth["views"] = Json::array();
  const std::vector<std::pair<double, double>> leans{{18, -40}, {18.5, -90}, {18, -140}};
  for (std::size_t k = 0; k < leans.size(); ++k) {
    const std::string name = "v" + std::to_string(k);
    Json photos = Json::array();
    for (const double exposure_s : {0.02, 0.0025, 0.0003})
      photos.push_back({{"file", "photos/" + name + "_" + std::to_string(photos.size()) + ".png"},
                        {"light", "lamp"},
                        {"exposure_s", exposure_s},
                        {"iso", 100},
                        {"f_number", 8}});
    truth["views"].push_back(
        {{"view", name}, {"T_camera_board", pose(eye_for(lamp, leans[k].first, leans[k].second))}, {"photos", photos}});
  }
  return truth;
}

// What a calibration would have measured, without error.
Bench measured_bench(const BenchTruth& truth) {
  Bench bench;
  bench.lens = truth.lens;
  for (const TruthView& v : truth.views) {
    View view;
    view.name = v.name;
    view.T_camera_board = v.T_camera_board;
    bench.views.push_back(view);
  }
  bench.lights = truth.lights;
  bench.material = truth.board.material;
  bench.depth_field.terms = {truth.depth_gradient.x(), truth.depth_gradient.y(), 0, 0, 0, truth.wear};
  bench.machine_affine = truth.machine_affine;
  bench.crossings = Crossings::last;
  return bench;
}

// Three pictures with smooth grays and edges, nothing in common.
Image picture(int which, int pixels) {
  Image image(pixels, pixels, 1);
  for (int y = 0; y < pixels; ++y)
    for (int x = 0; x < pixels; ++x) {
      const double u = (x + 0.5) / pixels - 0.5, v = (y + 0.5) / pixels - 0.5, r = std::hypot(u, v);
      double value = 0;
      if (which == 0) value = r < 0.3 ? 0.85 - 0.8 * r : 0.3 + 0.3 * u;
      if (which == 1) value = 0.5 + 0.25 * std::sin(9 * u) * std::cos(7 * v) + (std::abs(u) < 0.08 ? 0.2 : 0);
      if (which == 2) value = u + v > 0.1 ? 0.75 - 0.4 * v : 0.35 + 0.5 * r;
      image.at(x, y) = static_cast<float>(std::clamp(value, 0.0, 1.0));
    }
  return image;
}

class MeasuredBench : public testing::Test {
 protected:
  void SetUp() override {
    write_json(truth_of(size_), folder_ / "truth.json");
    truth_ = read_bench_truth(folder_ / "truth.json");
    bench_ = measured_bench(truth_);
    spec_.scratches = size_.scratches;
    for (int k = 0; k < 3; ++k) {
      DesignView view;
      view.view = "v" + std::to_string(k);
      view.target.image = picture(k, size_.pixels);
      spec_.views.push_back(view);
    }
  }

  // In dB, means over the views: how much worse the photos are, and by how much the promise was too good.
  struct Ignored {
    double cost_db = 0, broken_db = 0;
  };

  struct Round {
    std::vector<double> promised_db, photographed_db;
  };

  // Designed for a bench as it is believed to be, carved and photographed as it is.
  Round turn(const Bench& believed, const std::string& name) {
    DesignOptions options;
    options.pixels = size_.pixels;
    options.iterations = size_.iterations;
    const DesignResult designed = design(spec_, truth_.board, believed, options, {});
    Round round;
    for (const DesignedView& v : designed.views) round.promised_db.push_back(v.psnr_db);
    const std::filesystem::path sent = folder_ / (name + ".csv");
    write_toolpath(designed.scratches, truth_.board, &believed, machine_profile("grbl"), {}, sent);
    SimulateOptions simulated;
    simulated.scratches = sent;
    simulate(folder_ / "truth.json", folder_ / name, simulated);
    const Session session = read_session(folder_ / name / "session.json");
    for (const DesignedView& v : designed.views) round.photographed_db.push_back(photographed_db(session, v));
    return round;
  }

  // PSNR of the photo of a view against its target, at the exposure that comes nearest.
  double photographed_db(const Session& session, const DesignedView& v) const {
    std::vector<Photo> photos;
    for (const Photo& p : session.photos)
      if (p.view == v.view) photos.push_back(p);
    const MergedView merged = merge_bracket(photos);
    // Finer than the design's pixels, then their mean: a pixel of the design is an area.
    constexpr int kFiner = 3;
    const BoardFrame frame{{kEdge_mm, kEdge_mm},
                           {kBoard_mm - kEdge_mm, kBoard_mm - kEdge_mm},
                           kFiner * v.target.width,
                           kFiner * v.target.height};
    const Image seen = resized(rectified(luminance(merged.value), 0, 0, bench_.lens,
                                         find_view(bench_, v.view, "test").T_camera_board, truth_.surface, frame),
                               v.target.width, v.target.height);
    double mean = 0;
    for (const float value : seen.data) mean += value / static_cast<double>(seen.data.size());
    EXPECT_GT(mean, 0) << v.view;
    return psnr_db(shown_picture(seen, best_exposure(seen, v.target, 0.2 / mean)), v.target);
  }

  const Size size_ = size_asked_for();
  TemporaryFolder folder_;
  BenchTruth truth_;
  Bench bench_;
  DesignSpec spec_;
};

TEST_F(MeasuredBench, PhotosShowWhatTheDesignPromised) {
  const Round known = turn(bench_, "known");
  for (std::size_t k = 0; k < 3; ++k) {
    std::printf("%-22s v%zu: promised %.2f dB, photographed %.2f dB\n", "all known", k, known.promised_db[k],
                known.photographed_db[k]);
    EXPECT_NEAR(known.photographed_db[k], known.promised_db[k], 0.5) << "view " << k;
  }
  const auto ignored = [&](const char* what, const std::function<void(Bench&)>& forget) {
    Bench believed = bench_;
    forget(believed);
    const Round round = turn(believed, what);
    double cost = 0, broken = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      cost += (known.photographed_db[k] - round.photographed_db[k]) / 3;
      broken += (round.promised_db[k] - round.photographed_db[k]) / 3;
      std::printf("%-22s v%zu: promised %.2f dB, photographed %.2f dB, costs %.2f dB\n", what, k, round.promised_db[k],
                  round.photographed_db[k], known.photographed_db[k] - round.photographed_db[k]);
    }
    return Ignored{cost, broken};
  };
  constexpr std::size_t kWear = GrooveField::kTerms - 1;
  const Ignored field = ignored("no depth field", [](Bench& b) {
    const double wear = b.depth_field.wear();
    b.depth_field.terms = {};
    b.depth_field.terms[kWear] = wear;
  });
  const Ignored wear = ignored("no wear", [](Bench& b) { b.depth_field.terms[kWear] = 0; });
  const Ignored crossings = ignored("crossings add", [](Bench& b) { b.crossings = Crossings::add; });
  const Ignored map =
      ignored("no machine map", [](Bench& b) { b.machine_affine = (Affine2() << 1, 0, 0, 0, 1, 0).finished(); });
  std::printf(
      "means over the views: photos are worse by (promises are too good by): depth field %.2f (%.2f), wear %.2f "
      "(%.2f), crossings %.2f (%.2f), map %.2f (%.2f) dB\n",
      field.cost_db, field.broken_db, wear.cost_db, wear.broken_db, crossings.cost_db, crossings.broken_db, map.cost_db,
      map.broken_db);
  // What must show on any bench like this one: a map that is not undone spoils the pictures, and whoever takes grooves
  // that cross to add up promises what no board can keep.
  EXPECT_GT(map.cost_db, 0.5);
  EXPECT_GT(crossings.broken_db, 1.5);
}

}  // namespace
}  // namespace burin
