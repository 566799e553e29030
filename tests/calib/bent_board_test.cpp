// A sheet bent to a quarter of a tube, photographed by the point sampler (which has a cylinder of its own) with noise,
// blur and a lens: what calibrate makes of its tags and refine of every pixel, begun with a radius that is 5 % wrong
// and an axis that is 1 degree off. And the derivatives that both rest on.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "burin/calib/calibrate.h"
#include "burin/calib/geometry/bundle.h"
#include "burin/calib/refine.h"
#include "burin/capture/session.h"
#include "burin/capture/simulator/simulated_camera.h"
#include "burin/render/board_face.h"
#include "burin/render/files/json_file.h"
#include "burin/render/scratches.h"
#include "tests/temporary_folder.h"

namespace burin {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kRadius = 76.4;  // 90 degrees of a sheet of 120 mm

Json pose_json(const Vector3d& eye, const Vector3d& aim) {
  const Vector3d z = (aim - eye).normalized(), x = z.cross(Vector3d::UnitY()).normalized(), y = z.cross(x);
  Json rows = Json::array();
  for (const Vector3d& axis : {x, y, z}) rows.push_back({axis.x(), axis.y(), axis.z(), -axis.dot(eye)});
  rows.push_back({0, 0, 0, 1});
  return rows;
}

Json bent_truth() {
  Json truth = Json::parse(R"({
    "format": "burin/rig-truth", "version": 1, "name": "bent", "seed": 5, "samples": 81, "samples_plain": 9,
    "board": { "size_mm": [120, 120], "carve_mm": [[20, 20], [100, 100]],
               "tags": { "family": "tagStandard41h12", "z_mm": 0.1, "sigma_mm": 0.1, "white_albedo": 0.85,
                         "black_albedo": 0.04, "quiet_mm": 0.5, "list": [] },
               "tool": { "width_um": 400 } },
    "believed": { "bend": { "radius_mm": 80, "axis_deg": 1 },
                  "material": { "alpha": 0.05, "depth_um": 13, "base_alpha": 0.1, "f0": [0.91, 0.92, 0.92] } },
    "material": { "alpha": 0.06, "depth_um": 15, "base_alpha": 0.12, "f0": [0.91, 0.92, 0.92] },
    "scratches": { "random": { "count": 2500, "length_mm": [3, 5], "seed": 4211 } },
    "camera": { "lensmodel": "LENSMODEL_OPENCV4", "imagersize": [800, 640],
                "intrinsics": [2054, 2053, 401.3, 317.9, -0.07, 0.05, 0.0002, -0.0001] },
    "sensor": { "channels": 1, "bits": 12, "encoding": "linear", "gain": 11500, "full_well_e": 18000, "read_noise_e": 9 },
    "lights": [ { "id": "lamp", "position_mm": [69, -319, 452.5], "intensity": [320000, 320000, 320000] } ],
    "psf_sigma_px": 0.45, "ambient": [0.004, 0.004, 0.004],
    "background": { "albedo": [0.03, 0.03, 0.03], "noise": 0.4, "z_mm": -60 },
    "exif": { "make": "Altair", "model": "M07", "focal_mm": 50 }, "session": true, "views": []
  })");
  truth["board"]["bend"] = {{"radius_mm", kRadius}, {"axis_deg", 0}};
  int id = 0;
  for (const double y : {10., 35., 60., 85., 110.})
    for (const double x : {10., 35., 60., 85., 110.})
      if (x == 10 || x == 110 || y == 10 || y == 110)
        truth["board"]["tags"]["list"].push_back({{"id", id++}, {"center_mm", {x, y}}, {"size_mm", 10}});
  const double degree = std::acos(-1.0) / 180;
  int n = 0;
  for (const auto& [across, along, distance] : {std::tuple(0., 2., 520.),
                                                {28., 5., 530.},
                                                {-28., 8., 540.},
                                                {12., 25., 520.},
                                                {-15., -22., 530.},
                                                {35., -15., 540.},
                                                {-35., 15., 535.},
                                                {5., 32., 540.}}) {
    const Vector3d aim(60, 60, -10);
    const double a = across * degree, b = along * degree;
    const Vector3d eye = aim + distance * Vector3d(std::sin(a), std::cos(a) * std::sin(b), std::cos(a) * std::cos(b));
    Json view{{"view", "v" + std::to_string(n)}, {"T_camera_board", pose_json(eye, aim)}};
    for (const auto& [letter, exposure] : {std::pair("a", 0.0125), {"b", 0.0015625}, {"c", 0.0002}})
      view["photos"].push_back({{"file", "photos/v" + std::to_string(n) + letter + ".png"},
                                {"light", "lamp"},
                                {"exposure_s", exposure},
                                {"iso", 100},
                                {"f_number", 8}});
    truth["views"].push_back(view);
    ++n;
  }
  return truth;
}

TEST(BentBoard, RadiusRoughnessAndDepthComeOutOfPhotos) {
  const TemporaryFolder folder;
  simulate(folder.write("truth.json", bent_truth().dump(1)), folder.path() / "photos-of-it");
  const Session session = read_session(folder.path() / "photos-of-it" / "session.json");
  const Board board = read_board(session.board);
  ASSERT_TRUE(board.bend);
  EXPECT_EQ(board.bend->radius_mm, 80);
  const Sent sent(read_scratches(board.scratches));

  const Calibration calibrated = calibrate(session, board);
  ASSERT_TRUE(calibrated.bench.bend);
  EXPECT_TRUE(calibrated.bench.bow_mm.isZero());
  EXPECT_NEAR(calibrated.bench.bend->radius_mm / kRadius, 1, 0.003);
  EXPECT_NEAR(std::remainder(calibrated.bench.bend->axis_deg, 180), 0, 0.1);
  ASSERT_TRUE(calibrated.bench.bend_sigma);
  EXPECT_LT(calibrated.bench.bend_sigma->radius_mm, 0.003 * kRadius);
  EXPECT_NEAR(calibrated.bench.bend->radius_mm, kRadius, 5 * calibrated.bench.bend_sigma->radius_mm);

  const Refinement refined = refine(session, board, sent, calibrated.bench, {});
  ASSERT_TRUE(refined.bench.bend);
  EXPECT_NEAR(refined.bench.bend->radius_mm / kRadius, 1, 0.003);
  EXPECT_NEAR(refined.bench.material.alpha / 0.06, 1, 0.01);
  EXPECT_NEAR(refined.bench.material.depth_um / 15, 1, 0.015);
}

TEST(BentBoard, BundleDerivativesAgainstCentralDifferences) {
  Bundle bundle;
  bundle.lens = plain_lens("LENSMODEL_OPENCV4", 2000, 800, 640);
  bundle.surface = {{120, 120}, {0.2, -0.3, 0}, Bend{80, 10}};
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() =
      (Eigen::AngleAxisd(3.0, Vector3d::UnitX()) * Eigen::AngleAxisd(0.2, Vector3d::UnitY())).toRotationMatrix();
  T.translation() = Vector3d(-60, 60, 520);
  bundle.views = {T};
  bundle.tags = {{{0.1, -0.2}, 0.01, 0.2, 0.02}};
  for (int k = 0; k < 4; ++k) {
    BundleCorner c;
    c.view = c.tag = 0;
    c.center_mm = {100, 20};
    c.offset_mm = Vector2d(k == 0 || k == 3 ? -5 : 5, k < 2 ? -5 : 5);
    c.z_mm = 0.1;
    c.q_px = {400, 300};
    bundle.corners.push_back(c);
  }
  // The gradient of the squared residuals is J^T r, in which every derivative of a corner's place stands.
  BundleOptions options;
  options.fix_lens = options.fix_tags = true;
  options.bow_prior_mm = options.edge_prior_mm = 1e9;
  options.hold_tag_set = false;
  const BundleEquations equations = bundle_equations(bundle, options);
  ASSERT_GE(equations.shared_at, 0);
  ASSERT_TRUE(equations.views[0].used);
  const auto half_square = [&](const Bundle& b) {
    double sum = 0;
    for (const Vector2d& r : bundle_residuals_px(b)) sum += 0.5 * r.squaredNorm();
    return sum;
  };
  constexpr double kStep = 1e-5;
  for (int k = 0; k < 2; ++k) {
    Bundle plus = bundle, minus = bundle;
    plus.surface.bow_mm[k] += kStep;
    minus.surface.bow_mm[k] -= kStep;
    const double by_difference = (half_square(plus) - half_square(minus)) / (2 * kStep);
    // gradient with the pose eliminated = own - B^T H^-1 g.
    const auto& view = equations.views[0];
    const double eliminated = view.gradient[equations.shared_at + 1 + k];
    const double own = eliminated + (view.B.transpose() * view.H.ldlt().solve(view.g))[equations.shared_at + 1 + k];
    EXPECT_NEAR(own, by_difference, 1e-4 * std::abs(by_difference)) << k;
    EXPECT_GT(std::abs(by_difference), 1) << k;
  }
}

}  // namespace
}  // namespace burin
