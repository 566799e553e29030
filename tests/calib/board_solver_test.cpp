// Poses, lens, bow and tags from tags: photographed benches against their truth, and synthetic ones against their
// predicted uncertainty.
#include "burin/calib/geometry/board_solver.h"
#include "tests/places.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <numbers>
#include <random>

#include "burin/base/error.h"
#include "tests/calib/rig_truth.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

struct DetectedRig {
  RigTruth truth;
  Board board;
  std::vector<ViewTags> pictures;
};

DetectedRig detect_rig(const fs::path& folder) {
  DetectedRig rig{read_rig_truth(folder), read_board(folder / "board.json"), {}};
  TagDetector detector(rig.board.tags.family);
  std::vector<int> ids;
  for (const Tag& tag : rig.board.tags.list) ids.push_back(tag.id);
  for (const auto& view : rig.truth.views) {
    const RigPhoto photo = merge_for_test(folder, rig.truth, view);
    rig.pictures.push_back({view.name, view.photos[0].file, detector.detect(photo.linear, photo.valid, ids).tags, {}});
  }
  return rig;
}

// Proves: on photographs of a bench with known truth, camera centers come out where they stood (0.15 mm RMS on
// the clean bench, 0.5 mm on the amateur's; both from some 0.7 m away), and errors are of the size that the covariance
// says.
class BoardOfRig : public testing::TestWithParam<std::tuple<const char*, double, double>> {};
TEST_P(BoardOfRig, CamerasAreWhereTheyWere) {
  const auto [name, bound_mm, bound_px] = GetParam();
  const fs::path folder = places::rig(name);
  if (!fs::exists(folder / "truth.json")) GTEST_SKIP() << "needs the photographed bench " << folder;
  const DetectedRig rig = detect_rig(folder);
  const BoardSolution s = solve_board(rig.board, rig.pictures, rig.truth.lens.width, rig.truth.lens.height);
  for (const Finding& f : s.findings) std::printf("  %s\n", sentence(f).c_str());
  ASSERT_EQ(s.views.size(), rig.truth.views.size());
  double sum2 = 0, normalized2 = 0;
  for (std::size_t v = 0; v < s.views.size(); ++v) {
    const Eigen::Vector3d e =
        s.views[v].T_camera_board.inverse().translation() - rig.truth.views[v].T_camera_board.inverse().translation();
    sum2 += e.squaredNorm();
    normalized2 += e.dot(s.center_covariance_mm2[v].ldlt().solve(e));
    const Eigen::Vector3d g = *s.views[v].center_sigma_mm;
    std::printf("  %s: error %6.3f %6.3f %6.3f mm, sigma %.3f %.3f %.3f, rms %.4f px, %d tags\n",
                s.views[v].name.c_str(), e.x(), e.y(), e.z(), g.x(), g.y(), g.z(), *s.views[v].reprojection_rms_px,
                *s.views[v].tags);
  }
  double tag2 = 0, tag_n2 = 0;
  for (std::size_t t = 0; t < s.tags.size(); ++t) {
    const Eigen::Vector2d e = s.tags[t].center_mm - true_tag(rig.truth, s.tags[t].id).center_mm;
    tag2 += e.squaredNorm() / 2;
    tag_n2 += e.cwiseQuotient(s.tag_sigma[t].head<2>()).squaredNorm() / 2;
  }
  const double rms = std::sqrt(sum2 / s.views.size());
  std::printf(
      "%s: centers %.3f mm RMS (in sigmas %.2f), corners %.4f px, f %.2f %.2f (true %.2f %.2f, sigma %.2f) %s\n", name,
      rms, std::sqrt(normalized2 / 3 / s.views.size()), s.rms_px, s.lens.intrinsics[0], s.lens.intrinsics[1],
      rig.truth.lens.intrinsics[0], rig.truth.lens.intrinsics[1], std::sqrt(s.lens_covariance(0, 0)),
      s.lens.model.c_str());
  std::printf(
      "  tags %.4f mm RMS (in sigmas %.2f), edge %.4f +- %.4f, bow %.4f %.4f %.4f +- %.4f %.4f %.4f (true %.3f %.3f "
      "%.3f); mrcal moves %.5f px %.4f mm\n",
      std::sqrt(tag2 / s.tags.size()), std::sqrt(tag_n2 / s.tags.size()), s.edge_mm, s.edge_sigma_mm, s.bow_mm[0],
      s.bow_mm[1], s.bow_mm[2], s.bow_sigma_mm[0], s.bow_sigma_mm[1], s.bow_sigma_mm[2], rig.truth.surface.bow_mm[0],
      rig.truth.surface.bow_mm[1], rig.truth.surface.bow_mm[2], s.check->max_shift_px, s.check->max_center_mm);
  EXPECT_LT(rms, bound_mm);
  EXPECT_LT(s.rms_px, bound_px);
  EXPECT_LT(std::sqrt(normalized2 / 3 / s.views.size()), 2);
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(s.bow_mm[i], rig.truth.surface.bow_mm[i], 3 * s.bow_sigma_mm[i] + 0.002);
  EXPECT_LT(s.check->max_shift_px, 0.01);
}
INSTANTIATE_TEST_SUITE_P(Rigs, BoardOfRig,
                         testing::Values(std::tuple("b-small", 0.5, 0.06), std::tuple("a", 0.15, 0.02),
                                         std::tuple("b", 0.5, 0.06)),
                         [](const auto& info) {
                           std::string name = std::get<0>(info.param);
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

// A world without photos: tags around a board, views all around it, corners projected by a known lens with Gaussian
// noise.
struct World {
  Board board;  // as believed
  std::vector<Tag> true_tags;
  Surface surface;
  Lens lens;
  std::vector<Eigen::Isometry3d> T_camera_board;
  std::vector<ViewTags> pictures;
};

constexpr double kNoise_px = 0.03;

Eigen::Isometry3d looking_at(const Eigen::Vector3d& center, const Eigen::Vector3d& target, double roll_rad) {
  const Eigen::Vector3d z = (target - center).normalized();
  const Eigen::Vector3d x0 = Eigen::Vector3d(-z.y(), z.x(), 0.01).cross(z).cross(z).normalized(), y0 = z.cross(x0);
  Eigen::Matrix3d R;  // rows: the camera's axes on the board
  R.row(0) = std::cos(roll_rad) * x0 + std::sin(roll_rad) * y0;
  R.row(1) = -std::sin(roll_rad) * x0 + std::cos(roll_rad) * y0;
  R.row(2) = z;
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = R;
  T.translation() = -R * center;
  return T;
}

void photograph(World& w, std::mt19937& random) {
  std::normal_distribution<double> gauss;
  w.pictures.clear();
  for (std::size_t v = 0; v < w.T_camera_board.size(); ++v) {
    ViewTags picture{"v" + std::to_string(v), "photo" + std::to_string(v) + ".png", {}, {}};
    for (const Tag& tag : w.true_tags) {
      TagDetection d;
      d.id = tag.id;
      const auto corners = tag_corners_mm(tag);
      // Straight-line corners are what a detector measures: the lens' curvature of the sides is added, as it would be
      // there.
      auto pixel = [&](const Eigen::Vector2d& xy) {
        const Eigen::Vector3d p(xy.x(), xy.y(), height_mm(w.surface, xy.x(), xy.y()) + w.board.tags.z_mm);
        const Eigen::Vector3d c = w.T_camera_board[v] * p;
        Eigen::Vector2d q;
        project(w.lens, {&c, 1}, {&q, 1});
        return q;
      };
      const auto bias = curved_side_bias_px(
          [&](int i, double t) { return pixel(corners[i] + t * (corners[(i + 1) % 4] - corners[i])); },
          side_skip_fraction(w.board.tags.family));
      bool inside = true;
      for (int k = 0; k < 4; ++k) {
        d.corner_px[k] = pixel(corners[k]) + bias[k] + kNoise_px * Eigen::Vector2d(gauss(random), gauss(random));
        d.coarse_px[k] = d.corner_px[k];
        d.corner_sigma_px[k] = 0.02;  // what a detector believes: not quite the noise there is
        inside = inside && d.corner_px[k].x() > 5 && d.corner_px[k].y() > 5 && d.corner_px[k].x() < w.lens.width - 6 &&
                 d.corner_px[k].y() < w.lens.height - 6;
      }
      if (inside) picture.tags.push_back(d);
    }
    w.pictures.push_back(picture);
  }
}

// `stray`: a tag that will not be where it should, and so does not count for the frame.
World make_world(unsigned seed, int views = 10, int stray = -1) {
  std::mt19937 random(seed);
  std::normal_distribution<double> gauss;
  std::uniform_real_distribution<double> uniform(-1, 1);
  World w;
  w.board.size_mm = {280, 220};
  w.board.tags.sigma_mm = 0.2;
  int id = 0;
  for (int i = 0; i < 5; ++i)
    for (const double y : {14.0, 206.0}) w.board.tags.list.push_back({id++, {14 + 63.0 * i, y}, 16, 0});
  for (int i = 1; i < 4; ++i)
    for (const double x : {14.0, 266.0}) w.board.tags.list.push_back({id++, {x, 14 + 48.0 * i}, 16, 90});
  // True places: off by sigma, but the set as a whole neither shifted nor turned nor grown (the frame's definition).
  const int n = id;
  Eigen::VectorXd d(2 * n);
  Eigen::MatrixXd gauge = Eigen::MatrixXd::Zero(2 * n, 4);
  for (int i = 0; i < n; ++i) {
    d.segment<2>(2 * i) = 0.2 * Eigen::Vector2d(gauss(random), gauss(random));
    const Eigen::Vector2d r = w.board.tags.list[i].center_mm - Eigen::Vector2d(140, 110);
    gauge.block<2, 4>(2 * i, 0) << 1, 0, -r.y(), r.x(), 0, 1, r.x(), r.y();
  }
  if (stray >= 0) gauge.middleRows<2>(2 * stray).setZero();
  d -= gauge * (gauge.transpose() * gauge).ldlt().solve(gauge.transpose() * d);
  w.true_tags = w.board.tags.list;
  for (int i = 0; i < n; ++i) {
    w.true_tags[i].center_mm += d.segment<2>(2 * i);
    w.true_tags[i].rotation_deg += 1.0 * gauss(random);
  }
  w.surface.size_mm = w.board.size_mm;
  for (int i = 0; i < 3; ++i) w.surface.bow_mm[i] = 0.1 * gauss(random);
  w.lens.model = "LENSMODEL_OPENCV5";
  w.lens.width = 2000;
  w.lens.height = 1500;
  w.lens.intrinsics = {2800 + 200 * uniform(random),
                       0,
                       1000 + 20 * uniform(random),
                       750 + 20 * uniform(random),
                       -0.15 + 0.05 * uniform(random),
                       0.12,
                       3e-4 * uniform(random),
                       3e-4 * uniform(random),
                       -0.02};
  w.lens.intrinsics[1] = w.lens.intrinsics[0] * (1 + 1e-3 * uniform(random));
  for (int v = 0; v < views; ++v) {
    const double azimuth = 2 * std::numbers::pi * v / views + 0.3 * uniform(random),
                 tilt = 0.55 + 0.25 * uniform(random), far = 650 + 120 * uniform(random);
    const Eigen::Vector3d target(140 + 20 * uniform(random), 110 + 20 * uniform(random), 0);
    w.T_camera_board.push_back(
        looking_at(target + far * Eigen::Vector3d(std::sin(tilt) * std::cos(azimuth),
                                                  std::sin(tilt) * std::sin(azimuth), std::cos(tilt)),
                   target, uniform(random) * 3));
  }
  photograph(w, random);
  return w;
}

std::string all_findings(const BoardSolution& s) {
  std::string out;
  for (const Finding& f : s.findings) out += sentence(f) + "\n";
  return out;
}

// Proves: the covariance is honest. Over 12 worlds with fresh lens, bow, tags, places and noise, errors in units of
// their sigma have RMS near 1 for each kind of parameter (bounds: views of a world share lens and bow, so that far
// fewer than their number are independent), and none is beyond 5.
TEST(BoardSolver, SyntheticWorldsLieWithinTheirPredictedUncertainty) {
  double center2 = 0, bow2 = 0, tag2 = 0, focal2 = 0, turn2 = 0;
  int centers = 0, bows = 0, tags = 0, focals = 0;
  for (unsigned seed = 1; seed <= 12; ++seed) {
    const World w = make_world(seed);
    BoardSolverOptions options;
    options.check_with_mrcal = false;
    const BoardSolution s = solve_board(w.board, w.pictures, w.lens.width, w.lens.height, options);
    ASSERT_EQ(s.views.size(), w.T_camera_board.size()) << all_findings(s);
    EXPECT_EQ(s.focal_scatter, 0) << "seed " << seed;
    for (std::size_t v = 0; v < s.views.size(); ++v) {
      const Eigen::Vector3d e =
          s.views[v].T_camera_board.inverse().translation() - w.T_camera_board[v].inverse().translation();
      const Eigen::Vector3d z = e.cwiseQuotient(*s.views[v].center_sigma_mm);
      EXPECT_LT(z.cwiseAbs().maxCoeff(), 5) << "seed " << seed << " view " << v;
      center2 += z.squaredNorm();
      centers += 3;
    }
    const Eigen::Vector3d b = (s.bow_mm - w.surface.bow_mm).cwiseQuotient(s.bow_sigma_mm);
    EXPECT_LT(b.cwiseAbs().maxCoeff(), 5) << "seed " << seed;
    bow2 += b.squaredNorm();
    bows += 3;
    for (std::size_t t = 0; t < s.tags.size(); ++t) {
      const Tag& truth =
          *std::find_if(w.true_tags.begin(), w.true_tags.end(), [&](const Tag& g) { return g.id == s.tags[t].id; });
      tag2 += (s.tags[t].center_mm - truth.center_mm).cwiseQuotient(s.tag_sigma[t].head<2>()).squaredNorm();
      turn2 += 2 * std::pow((s.tags[t].rotation_deg - truth.rotation_deg) / 57.29578 / s.tag_sigma[t].z(), 2);
      tags += 2;
    }
    focal2 += std::pow((s.lens.intrinsics[0] - w.lens.intrinsics[0]) / std::sqrt(s.lens_covariance(0, 0)), 2);
    focals += 1;
  }
  std::printf("errors in sigmas: centers %.2f, bow %.2f, tags %.2f, turns %.2f, focal length %.2f\n",
              std::sqrt(center2 / centers), std::sqrt(bow2 / bows), std::sqrt(tag2 / tags), std::sqrt(turn2 / tags),
              std::sqrt(focal2 / focals));
  EXPECT_NEAR(std::sqrt(center2 / centers), 1, 0.4);
  EXPECT_NEAR(std::sqrt(bow2 / bows), 1, 0.4);
  EXPECT_NEAR(std::sqrt(tag2 / tags), 1, 0.25);
  EXPECT_NEAR(std::sqrt(turn2 / tags), 1, 0.25);
  EXPECT_NEAR(std::sqrt(focal2 / focals), 1, 0.6);
}

// Proves: what contradicts the rest is named, left out, and does no harm: the cameras are where they come out when it
// was never there, to a small part of their sigma (0.1 to 0.4 mm).
class Contradictions : public testing::Test {
 protected:
  World world = make_world(77, 10, 6);
  BoardSolution solve(const World& w) const {
    BoardSolverOptions options;
    options.check_with_mrcal = false;
    return solve_board(w.board, w.pictures, w.lens.width, w.lens.height, options);
  }
  BoardSolution solve_without_tag_6() const {
    World without = world;
    for (ViewTags& picture : without.pictures)
      std::erase_if(picture.tags, [](const TagDetection& t) { return t.id == 6; });
    return solve(without);
  }
  static double worst_difference_mm(const BoardSolution& a, const BoardSolution& b) {
    double worst = 0;
    for (const View& view : a.views)
      for (const View& other : b.views)
        if (view.name == other.name)
          worst = std::max(
              worst,
              (view.T_camera_board.inverse().translation() - other.T_camera_board.inverse().translation()).norm());
    return worst;
  }
};
constexpr double kNoHarm_mm = 0.03;

TEST_F(Contradictions, ATagInTheWrongPlace) {
  world.true_tags[6].center_mm += Eigen::Vector2d(2.5, -1.5);
  std::mt19937 random(5);
  photograph(world, random);
  const BoardSolution s = solve(world);
  EXPECT_THAT(all_findings(s), testing::HasSubstr("tag 6 is left out"));
  EXPECT_EQ(s.tags.size(), world.board.tags.list.size() - 1) << all_findings(s);
  EXPECT_LT(worst_difference_mm(s, solve_without_tag_6()), kNoHarm_mm);
}

TEST_F(Contradictions, ATagThatPeels) {
  std::mt19937 random(6);
  std::uniform_real_distribution<double> lift(1, 4);
  for (ViewTags& picture : world.pictures)
    for (TagDetection& tag : picture.tags)
      if (tag.id == 6) {
        tag.corner_px[2] += Eigen::Vector2d(lift(random), lift(random));
        tag.corner_px[3] -= Eigen::Vector2d(lift(random), -lift(random));
      }
  const BoardSolution s = solve(world);
  EXPECT_THAT(all_findings(s), testing::HasSubstr("tag 6 is left out"));
  EXPECT_EQ(s.tags.size(), world.board.tags.list.size() - 1) << all_findings(s);
  EXPECT_LT(worst_difference_mm(s, solve_without_tag_6()), kNoHarm_mm);
}

TEST_F(Contradictions, APhotoWithAnotherFocalLength) {
  World without = world;
  without.pictures.erase(without.pictures.begin() + 3);
  for (TagDetection& tag : world.pictures[3].tags)
    for (Eigen::Vector2d& q : tag.corner_px) q = Eigen::Vector2d(1000, 750) + 1.15 * (q - Eigen::Vector2d(1000, 750));
  // A digital zoom: measured, and no harm to the others. (It is one photo more: they move, within their sigmas.)
  const BoardSolution s = solve(world);
  EXPECT_THAT(all_findings(s), testing::HasSubstr("view v3 has a focal length 1.15"));
  for (const View& view : s.views) {
    const Eigen::Vector3d error = view.T_camera_board.inverse().translation() -
                                  world.T_camera_board[std::stoul(view.name.substr(1))].inverse().translation();
    EXPECT_LT(error.cwiseQuotient(*view.center_sigma_mm).cwiseAbs().maxCoeff(), 4) << view.name;
  }
  const auto zoomed = std::find_if(s.views.begin(), s.views.end(), [](const View& view) { return view.name == "v3"; });
  ASSERT_NE(zoomed, s.views.end()) << all_findings(s);
  EXPECT_NEAR(zoomed->own_lens->focal_ratio, 1.15, 4 * zoomed->own_lens_sigma->focal_ratio);
  // Where views may have no lens of their own, it is left out.
  BoardSolverOptions one_lens;
  one_lens.check_with_mrcal = one_lens.own_lenses = false;
  const BoardSolution left_out =
      solve_board(world.board, world.pictures, world.lens.width, world.lens.height, one_lens);
  EXPECT_THAT(all_findings(left_out), testing::HasSubstr("view v3 is left out"));
  EXPECT_EQ(left_out.views.size(), world.T_camera_board.size() - 1) << all_findings(left_out);
  EXPECT_LT(worst_difference_mm(left_out, solve(without)), kNoHarm_mm);
}

// A phone as it is: its stabilizer moves the principal point by 6 px, its focus the focal length by 1 %, in each photo
// anew. Cameras come out to a millimeter, by sigmas that say so.
TEST(BoardSolver, EachPhotoMayHaveALensOfItsOwn) {
  double z2 = 0, worst_mm = 0;
  int numbers = 0;
  for (const unsigned seed : {11U, 12U, 13U}) {
    World w = make_world(seed, 12);
    std::mt19937 random(seed);
    std::normal_distribution<double> shift(0, 6), focus(0, 0.01);
    for (ViewTags& picture : w.pictures) {
      const Eigen::Vector2d by(shift(random), shift(random)), middle(1000, 750);
      const double ratio = std::exp(focus(random));
      for (TagDetection& tag : picture.tags)
        for (Eigen::Vector2d& q : tag.corner_px) q = middle + by + ratio * (q - middle);
    }
    const BoardSolution s = solve_board(w.board, w.pictures, w.lens.width, w.lens.height);
    EXPECT_THAT(all_findings(s), testing::HasSubstr("focal lengths differ from photo to photo by")) << seed;
    ASSERT_EQ(s.views.size(), w.T_camera_board.size()) << all_findings(s);
    ASSERT_TRUE(s.lens_scatter);
    EXPECT_NEAR(s.lens_scatter->shift_px, 6, 3);
    EXPECT_NEAR(s.lens_scatter->focal, 0.01, 0.006);
    EXPECT_LT(s.check->max_shift_px, 0.01);  // mrcal's solver, which knows of one lens, of what that lens would show
    for (const View& view : s.views) {
      const std::size_t v = std::stoul(view.name.substr(1));
      const Eigen::Vector3d e =
          view.T_camera_board.inverse().translation() - w.T_camera_board[v].inverse().translation();
      const Eigen::Vector3d z = e.cwiseQuotient(*view.center_sigma_mm);
      EXPECT_LT(z.cwiseAbs().maxCoeff(), 4) << "seed " << seed << ", " << view.name;
      z2 += z.squaredNorm();
      numbers += 3;
      worst_mm = std::max(worst_mm, e.norm());
    }
  }
  std::printf("own lenses: errors %.2f sigmas, the worst camera %.2f mm off\n", std::sqrt(z2 / numbers), worst_mm);
  EXPECT_LT(worst_mm, 2.5);  // at 700 mm, by corners that scatter by 0.03 px
  EXPECT_NEAR(std::sqrt(z2 / numbers), 1, 0.4);
}

// A camera that focuses anew for each photo: named, and the cameras lie within what their sigmas say.
TEST(BoardSolver, FocusThatDiffersFromPhotoToPhotoIsCounted) {
  for (const double most : {0.003, 0.009, 0.03})
    for (const unsigned seed : {11U, 12U, 13U}) {
      World w = make_world(seed, 12);
      for (std::size_t v = 0; v < w.pictures.size(); ++v)
        for (TagDetection& tag : w.pictures[v].tags)
          for (Eigen::Vector2d& q : tag.corner_px)
            q = Eigen::Vector2d(1000, 750) +
                (1 + most * static_cast<double>((v * 7) % 4) / 3) * (q - Eigen::Vector2d(1000, 750));
      BoardSolverOptions options;
      options.check_with_mrcal = false;
      const BoardSolution s = solve_board(w.board, w.pictures, w.lens.width, w.lens.height, options);
      EXPECT_THAT(all_findings(s), testing::HasSubstr("focal lengths differ from photo to photo by")) << most;
      // Of the largest differences lens and tags take up some, which sigmas hold all the same.
      EXPECT_GT(s.focal_scatter, 0.3 * 0.37 * most) << most;
      EXPECT_LT(s.focal_scatter, 1.3 * 0.37 * most) << most;
      double z2 = 0;
      for (const View& view : s.views) {
        const std::size_t v = std::stoul(view.name.substr(1));
        const Eigen::Vector3d e =
            view.T_camera_board.inverse().translation() - w.T_camera_board[v].inverse().translation();
        const Eigen::Vector3d z = e.cwiseQuotient(*view.center_sigma_mm);
        EXPECT_LT(z.cwiseAbs().maxCoeff(), 4) << most << ", seed " << seed << ", " << view.name;
        z2 += z.squaredNorm() / static_cast<double>(3 * s.views.size());
      }
      std::printf("focus to %.1f %%: scatter %.2f %%, errors %.2f sigmas\n", 100 * most, 100 * s.focal_scatter,
                  std::sqrt(z2));
    }
}

TEST_F(Contradictions, FalseCorners) {
  const BoardSolution clean = solve(world);
  std::mt19937 random(8);
  std::uniform_real_distribution<double> off(-8, 8);
  int k = 0;
  for (ViewTags& picture : world.pictures)
    for (TagDetection& tag : picture.tags)
      for (Eigen::Vector2d& q : tag.corner_px)
        if (++k % 23 == 0) q += Eigen::Vector2d(off(random), off(random));
  const BoardSolution s = solve(world);
  EXPECT_EQ(s.views.size(), world.T_camera_board.size()) << all_findings(s);
  EXPECT_LT(worst_difference_mm(s, clean),
            0.15);  // one corner in 23 is gone: a fifth of a sigma of fresh noise, of 0.3 mm
}

// Proves: a lens that photos from straight above cannot tell is reported so, not printed with confidence, and nothing
// crashes.
TEST(BoardSolver, PhotosFromStraightAboveDoNotDetermineTheLens) {
  World w = make_world(3, 5);
  for (int v = 0; v < 5; ++v) w.T_camera_board[v] = looking_at({141.0 + v, 110.0 - v, 700}, {140, 110, 0}, 0.3 * v);
  std::mt19937 random(9);
  photograph(w, random);
  const BoardSolution s = solve_board(w.board, w.pictures, w.lens.width, w.lens.height);
  EXPECT_THAT(s.not_determined, testing::Contains("lens.fx"));
  const double error =
      (s.views[0].T_camera_board.inverse().translation() - w.T_camera_board[0].inverse().translation()).norm();
  EXPECT_LT(error, 5 * s.views[0].center_sigma_mm->norm());
}

TEST(BoardSolver, TooFewViewsAreRefusedWithAReason) {
  World w = make_world(4, 3);
  w.pictures[1].tags.resize(2);
  EXPECT_THROW(
      try { solve_board(w.board, w.pictures, w.lens.width, w.lens.height); } catch (const Error& e) {
        EXPECT_THAT(e.what(), testing::AllOf(testing::HasSubstr("v1"), testing::HasSubstr("at least 3 places")));
        throw;
      },
      Error);
}

// Proves: with a lens that is given, one view is enough, and the lens comes back untouched.
TEST(BoardSolver, AGivenLensNeedsOneViewOnly) {
  World w = make_world(5, 3);
  w.pictures.resize(1);
  BoardSolverOptions options;
  options.lens = w.lens;
  options.fix_lens = true;
  const BoardSolution s = solve_board(w.board, w.pictures, w.lens.width, w.lens.height, options);
  ASSERT_EQ(s.views.size(), 1U);
  EXPECT_EQ(s.lens.intrinsics, w.lens.intrinsics);
  const Eigen::Vector3d e =
      s.views[0].T_camera_board.inverse().translation() - w.T_camera_board[0].inverse().translation();
  EXPECT_LT(e.cwiseQuotient(*s.views[0].center_sigma_mm).cwiseAbs().maxCoeff(), 4);
}

}  // namespace
}  // namespace burin
