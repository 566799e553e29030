// A sheet bent to a quarter of a tube, photographed by the point sampler (which has a cylinder of its own) with noise,
// blur and a lens: what calibrate makes of its tags and refine of every pixel, begun with a radius that is 5 % wrong
// and an axis that is 1 degree off. And the derivatives that both rest on.
#include <gtest/gtest.h>

#include <cmath>

#include "burin/calib/calibrate.h"
#include "burin/calib/geometry/bundle.h"
#include "burin/calib/refine.h"
#include "burin/capture/session.h"
#include "burin/scene/board_face.h"
#include "burin/scene/scratches.h"
#include "burin/simulate/simulated_camera.h"
#include "tests/calib/photographed_board.h"
#include "tests/temporary_folder.h"

namespace burin {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kRadius = 76.4;  // 90 degrees of a sheet of 120 mm

Json bent_truth() {
  Json truth = photographed_board("bent", 5, "lamp", {60, 60, -10}, 8);
  truth["samples"] = 81;
  truth["ambient"] = {0.004, 0.004, 0.004};
  truth["board"]["bend"] = {{"radius_mm", kRadius}, {"axis_deg", 0}};
  truth["believed"]["bend"] = {{"radius_mm", 80}, {"axis_deg", 1}};
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
