// What is proved: the tags' information about a pose is that of their corners' projections, by finite differences; a
// pose and its difference are each other's inverse; three joint steps bring poses that are wrong by a twentieth of a
// pixel back to where the picture was taken from, with all else, although nobody told which was wrong; and a number
// that photos push beyond its bounds is left there by steps and fits, the others at their best beside it; and a number
// that photos do not tell is not moved by what rounding says of it. Not proved: that real corners are as good as their
// RMS says (scripts/random-benches).
#include "burin/calib/geometry/geometry_prior.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "burin/calib/photo/machine_map.h"
#include "burin/calib/photo/normal_system.h"
#include "burin/calib/photo/photo_fit.h"
#include "burin/calib/verdict/photo_uncertainty.h"
#include "burin/scene/lens.h"
#include "tests/calib/fitted_grooves.h"

namespace burin {
namespace {

Bench two_views() {
  Bench bench;
  bench.lens.model = "LENSMODEL_PINHOLE";
  bench.lens.intrinsics = {420, 425, 80, 60};
  bench.lens.width = 160;
  bench.lens.height = 120;
  for (const double tilt : {0.35, -0.3, 0.1}) {
    View view;
    view.name = "v" + std::to_string(bench.views.size());
    const Eigen::Matrix3d R =
        (Eigen::AngleAxisd(tilt, Eigen::Vector3d::UnitX()) * Eigen::AngleAxisd(0.5 * tilt, Eigen::Vector3d::UnitY()) *
         Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX()))
            .toRotationMatrix();
    view.T_camera_board.linear() = R;
    view.T_camera_board.translation() = Eigen::Vector3d(0, 0, 190) - R * Eigen::Vector3d(30, 20, 0);
    view.reprojection_rms_px = 0.5;
    view.tags = 4;
    bench.views.push_back(view);
  }
  bench.lights.resize(1);
  return bench;
}

Board board_of_few_tags() {
  Board board;
  board.size_mm << 60, 40;
  board.carve_min_mm << 5, 5;
  board.carve_max_mm << 55, 35;
  board.tool_width_um = 600;
  for (int i = 0; i < 4; ++i) {
    Tag tag;
    tag.id = i;
    tag.center_mm << (i % 2 ? 57 : 3), (i / 2 ? 37 : 3);
    tag.size_mm = 3;
    board.tags.list.push_back(tag);
  }
  board.tags.z_mm = 0.1;
  return board;
}

TEST(Geometry, DifferenceAndMoveAreInverse) {
  const Eigen::Isometry3d T = two_views().views[0].T_camera_board;
  const Vector6 by = (Vector6() << 0.01, -0.02, 0.005, 0.3, -0.1, 0.7).finished();
  EXPECT_LT((pose_difference(T, moved_pose(T, by)) - by).norm(), 1e-12);
  EXPECT_LT(pose_difference(T, T).norm(), 1e-12);
}

TEST(Geometry, TagsThatAreExactTellTheirCornersInformation) {
  Board board = board_of_few_tags();
  const Bench bench = two_views();
  board.tags.sigma_mm = 1e-4;  // as exact as a prior gets
  const GeometryPrior prior = geometry_prior(board, bench);
  const Vector6 by = (Vector6() << 2e-5, -1e-5, 3e-5, 0.002, -0.003, 0.004).finished();
  const Eigen::Isometry3d T = bench.views[0].T_camera_board, moved = moved_pose(T, by);
  double sum = 0;  // of squared shifts of all corners, in sigmas
  for (const Tag& tag : board.tags.list)
    for (const double x : {-1.5, 1.5})
      for (const double y : {-1.5, 1.5}) {
        const Eigen::Vector3d p(tag.center_mm.x() + x, tag.center_mm.y() + y, 0.1);
        const std::vector<Eigen::Vector3d> both{T * p, moved * p};
        std::vector<Eigen::Vector2d> q(2);
        std::vector<PixelByPoint> dq_dp;
        project(bench.lens, both, q, &dq_dp);
        sum += (q[1] - q[0]).squaredNorm() / (0.5 * 0.5);
      }
  // With everything else held the information is that of the corners; that the lens is free can only take from it.
  Eigen::VectorXd all = Eigen::VectorXd::Zero(prior.information.rows());
  all.head<6>() = by;
  const double told = all.dot(prior.information * all);
  EXPECT_LT(told, 1.001 * sum);
  EXPECT_GT(told, 0.02 * sum);
  // A turn about the optical axis is nothing that a lens without distortion could make up for.
  all.setZero();
  all[2] = 1e-4;
  const double turn = all.dot(prior.information * all);
  double turned = 0;
  for (const Tag& tag : board.tags.list)
    for (const double x : {-1.5, 1.5})
      for (const double y : {-1.5, 1.5}) {
        const Eigen::Vector3d p = T * Eigen::Vector3d(tag.center_mm.x() + x, tag.center_mm.y() + y, 0.1);
        turned += std::pow(1e-4 * 420 / p.z() * p.head<2>().norm() / 0.5, 2);
      }
  EXPECT_NEAR(turn / turned, 1, 0.1);
}

// A bow shows in how corners move against each other between views: with tags that lie anywhere it is unknown, with
// exact ones it is known to the corners' noise over the views' parallax.
TEST(Geometry, BowIsKnownAsWellAsTheTags) {
  Board board = board_of_few_tags();
  const Bench bench = two_views();
  const auto bow_sigma = [&](double tag_sigma_mm) {
    board.tags.sigma_mm = tag_sigma_mm;
    const Eigen::MatrixXd information = geometry_prior(board, bench).information;
    const Eigen::VectorXd scale = information.diagonal().cwiseSqrt().cwiseInverse();
    const Eigen::MatrixXd covariance = (scale.asDiagonal() * information * scale.asDiagonal()).inverse();
    return std::sqrt(covariance(18, 18)) * scale[18];
  };
  EXPECT_GT(bow_sigma(0.2), bow_sigma(0.001));
  EXPECT_LT(bow_sigma(0.001), 2);
  EXPECT_GT(bow_sigma(0.001), 0.01);
}

// A scene whose pictures are those of `truth`; fitted from there but for what `spoil` makes wrong of the bench and of
// what the tags say. How far off the board's middle is seen by each view before, and after three joint steps, px: lens
// and pose trade with each other, this does not.
struct Stepped {
  std::vector<double> before_px, after_px;
  double alpha_off = 0, alpha_sigma = 0;
};
template <typename Spoil>
Stepped three_steps(const Bench& truth, const Spoil& spoil) {
  const Board board = board_of_few_tags();
  Sent sent;
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> x(8, 52), y(8, 32), turn(0, std::numbers::pi);
  for (int i = 0; i < 120; ++i) {
    const double cx = x(random), cy = y(random), a = turn(random);
    sent.scratches.x0_mm.push_back(cx - 3 * std::cos(a));
    sent.scratches.y0_mm.push_back(cy - 3 * std::sin(a));
    sent.scratches.x1_mm.push_back(cx + 3 * std::cos(a));
    sent.scratches.y1_mm.push_back(cy + 3 * std::sin(a));
  }
  Problem data;
  data.model.board = &board;
  data.model.sent = &sent;
  data.model.center_mm << 30, 20;
  data.model.f0 = board.material.f0.mean();
  data.is_spot = {false};
  State state;
  state.lamps.resize(1);
  state.shared[unknown::log_alpha] = std::log(0.15);
  state.shared[unknown::log_depth] = std::log(25);
  state.shared[unknown::log_base_alpha] = std::log(0.3);
  put_machine_map({}, state.shared);
  state.shared[unknown::log_blur] = std::log(0.8);
  state.lamps[0] = {60, -60, 180, std::log(4e4), 30, 20, 0};

  std::vector<LightView> views;
  for (std::size_t k = 0; k < truth.views.size(); ++k) {
    LightView v;
    v.merged = v.view = k;
    v.window = {0, 0, 160, 120};
    v.value = Image(160, 120, 1);
    v.sigma = Image(160, 120, 1, 0.02F);
    v.valid.assign(160 * 120, 1);
    views.push_back(v);
  }
  take_lenses(truth, 1, views);
  for (LightView& v : views) {
    const PhotoData photo = make_photo_data(v, 1, board, truth, 2);
    v.value = predict(data.model, photo, state.of(0), carved_at(data.model, state.of(0)));
  }
  Bench bench = truth;
  data.geometry = geometry_prior(board, bench);
  spoil(bench, *data.geometry);
  take_lenses(bench, 1, views);
  State start = state;
  start.shared[unknown::log_alpha] += 0.02;
  const auto away = [&](std::size_t k) {
    const Eigen::Vector3d middle(30, 20, 0);
    std::vector<Eigen::Vector2d> q(1), true_q(1);
    project(lens_of(bench, bench.views[k]), std::vector<Eigen::Vector3d>{bench.views[k].T_camera_board * middle}, q);
    project(lens_of(truth, truth.views[k]), std::vector<Eigen::Vector3d>{truth.views[k].T_camera_board * middle},
            true_q);
    return (q[0] - true_q[0]).norm();
  };
  Stepped out;
  for (std::size_t k = 0; k < truth.views.size(); ++k) out.before_px.push_back(away(k));
  Stage stage;
  stage.hold({Group::machine});  // a shift common to all views would be the machine's as well
  for (int step = 0; step < 3; ++step) {
    data.photos = photos_at(views, 1, board, bench, 0.8);
    joint_step(data, stage, start, bench);
    take_lenses(bench, 1, views);
  }
  data.photos = photos_at(views, 1, board, bench, 0.8);
  for (std::size_t k = 0; k < truth.views.size(); ++k) out.after_px.push_back(away(k));
  out.alpha_sigma = uncertainty_of(data, stage, start).sigma(unknown::log_alpha);
  out.alpha_off = start.shared[unknown::log_alpha] - std::log(0.15);
  return out;
}

TEST(Geometry, StepsBringThePosesBack) {
  const Bench truth = two_views();
  const Stepped done = three_steps(truth, [&](Bench& bench, GeometryPrior& tags) {
    bench.views[1].T_camera_board =
        moved_pose(truth.views[1].T_camera_board, (Vector6() << 4e-5, -3e-5, 5e-5, 0.01, -0.015, 0.02).finished());
    tags.T_camera_board[1] = bench.views[1].T_camera_board;  // what the tags said was wrong
  });
  ASSERT_GT(done.before_px[1], 0.04);
  for (const double off : done.after_px) EXPECT_LT(off, 0.15 * done.before_px[1]);
  EXPECT_LT(done.alpha_sigma, 0.02);
  EXPECT_NEAR(done.alpha_off, 0, 0.1 * done.alpha_sigma);
}

// The same where each photo has a lens of its own, and the tags have two of them wrong: one that was zoomed, too.
TEST(Geometry, StepsBringOwnLensesBack) {
  Bench truth = two_views();
  truth.lens_scatter = {3, 0.01};
  truth.views[0].own_lens = {{1.5, -2}, 0.995};
  truth.views[1].own_lens = {{-3, 1}, 1.2};
  truth.views[2].own_lens = {{0.5, 2}, 1.004};
  const Stepped done = three_steps(truth, [&](Bench& bench, GeometryPrior&) {
    bench.views[0].own_lens->shift_px += Eigen::Vector2d(0.05, -0.03);
    bench.views[1].own_lens->shift_px += Eigen::Vector2d(-0.04, 0.06);
    bench.views[1].own_lens->focal_ratio *= 1.0002;
  });
  ASSERT_GT(done.before_px[0], 0.04);
  ASSERT_GT(done.before_px[1], 0.04);
  for (const double off : done.after_px) EXPECT_LT(off, 0.15 * done.before_px[0]);
  EXPECT_LT(done.alpha_sigma, 0.02);
  EXPECT_NEAR(done.alpha_off, 0, 0.1 * done.alpha_sigma);
}

// Photos that are darker everywhere than without any ambient light. Steps that take ambient light below nothing and
// put it back leave all others where they make up for it; as does a fit that searches on the way to there. Both must
// reach what is best without ambient light.
TEST(JointStep, WhatIsAtItsBoundTakesNothingAlong) {
  FittedGrooves f;
  fit_small_grooves(0, 1, f);
  for (PhotoData& photo : f.s.data.photos)
    for (float& value : photo.photo.value.data) value -= 3 * photo.photo.sigma.data[0];
  f.stage.hold({Group::blur});
  Stage dark = f.stage;
  dark.hold({Group::ambient});
  State best = f.state, fitted = f.state, stepped = f.state;
  best.shared[unknown::ambient] = 0;
  fitted.shared[unknown::ambient] = stepped.shared[unknown::ambient] = 1e-3;
  solve(f.s.data, dark, 50, 1e-10, best, {}, "");
  solve(f.s.data, f.stage, 50, 1e-10, fitted, {}, "");
  Bench bench = f.s.bench;
  for (int step = 0; step < 4; ++step) joint_step(f.s.data, f.stage, stepped, bench);
  const double least = cost_of(f.s.data, best, 1);
  for (const State& state : {fitted, stepped}) {
    EXPECT_EQ(state.shared[unknown::ambient], 0);
    EXPECT_LT(cost_of(f.s.data, state, 1), 1.0005 * least);
  }
}

// Flanks far steeper than the grooves ever become, and photos as a camera would take them: what rounding alone says of
// the flanks must not move them, far less all that would follow.
TEST(JointStep, WhatPhotosDoNotTellStays) {
  FittedGrooves f;
  fit_small_grooves(0, 1, f);
  constexpr double kFlank_deg = 60;
  f.s.data.model.profile.kind = GrooveProfile::Kind::rounded_v;
  f.s.data.model.profile.flank_deg = kFlank_deg;
  for (PhotoData& photo : f.s.data.photos) photo.profile = f.s.data.model.profile;
  f.stage.free(Group::flank);
  State stepped = f.state;
  stepped.shared[unknown::flank] = kFlank_deg;
  Bench bench = f.s.bench;
  joint_step(f.s.data, f.stage, stepped, bench);
  EXPECT_EQ(stepped.shared[unknown::flank], kFlank_deg);
  EXPECT_LT(cost_of(f.s.data, stepped, 1), 1.001 * cost_of(f.s.data, f.state, 1));
}

}  // namespace
}  // namespace burin
