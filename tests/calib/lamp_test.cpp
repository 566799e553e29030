// What is proved: the lamp seed on photographed benches whose lamp is known (poses, lens and bow from truth.json, so
// that only the lamp's fit is on trial): position, spot exponent and base_alpha; the closed-form seed on exact shading;
// tag patterns against AprilTag's own rule for its borders. Not proved: that poses found from tags are good enough
// (calibrate_test), glints (refine_test).
#include "burin/calib/light/lamp.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <vector>

#include "burin/base/error.h"
#include "burin/calib/light/lamp_model.h"
#include "burin/calib/light/light_samples.h"
#include "burin/capture/photo.h"
#include "burin/capture/tags/tag_family.h"
#include "burin/scene/parameter_name.h"
#include "tests/calib/rig_bench.h"

namespace burin {
namespace {

TEST(TagPattern, BordersAreAsAprilTagDefinesThem) {
  // tag36h11: a white ring around a black ring around 6 x 6 bits; the corners that are reported enclose the black ring.
  const TagPattern classic = tag_pattern("tag36h11", 3);
  EXPECT_EQ(classic.total_cells, 10);
  EXPECT_EQ(classic.border_cells, 8);
  for (int i = 0; i < 10; ++i) {
    EXPECT_EQ(classic.color_at(i - 4.5, 4.5), 1);
    EXPECT_EQ(classic.color_at(i - 4.5, -4.5), 1);
  }
  for (int i = 1; i < 9; ++i) EXPECT_EQ(classic.color_at(i - 4.5, 3.5), 0);
  EXPECT_EQ(classic.color_at(5.1, 0), -1);
  EXPECT_THROW(tag_pattern("tag99h9", 0), Error);
  EXPECT_THROW(tag_pattern("tag36h11", 100000), Error);
}

TEST(LampFromShading, ExactShadingGivesTheLampBack) {
  const Eigen::Vector3d lamp(-80, 400, 700);
  std::vector<Eigen::Vector3d> points;
  std::vector<double> shading;
  for (int i = 0; i < 20; ++i) {
    const Eigen::Vector3d p(15.0 + 53 * (i % 5), 15.0 + 80 * (i / 5), 0.1);
    points.push_back(p);
    shading.push_back(3.7 * (lamp.z() - p.z()) / std::pow((lamp - p).norm(), 3));
  }
  const auto seed = lamp_from_shading(points, shading);
  ASSERT_TRUE(seed.has_value());
  EXPECT_LT((*seed - lamp).norm(), 1e-5);
  // Brightness that grows without bound away from a point is no lamp in front of the board.
  for (std::size_t i = 0; i < points.size(); ++i) shading[i] = 1 + (points[i] - points[7]).squaredNorm();
  EXPECT_FALSE(lamp_from_shading(points, shading).has_value());
}

TEST(LightSamples, WhereNoLargeBlockIsFreeOfGroovesSmallerOnesShowTheFace) {
  BURIN_NEEDS_RIG("b-small");
  const Rig rig = read_rig("b-small", {"v05"});
  Bench bench = rig.true_poses;
  std::vector<Finding> findings;
  const std::vector<LightView> views = make_light_views(merge_session(rig.session), rig.board, bench, findings);
  LightSampleOptions coarse;
  coarse.block_px = 128;  // as if a block of the usual side were as large as the board's free places
  std::size_t faces = 0;
  for (const LightSample& s : gather_light_samples(views, rig.board, bench, rig.sent, coarse))
    faces += s.kind == SampleKind::face;
  EXPECT_GE(faces, 30U);
}

struct RigLamp {
  Bench bench;
  nlohmann::json truth;
  std::vector<Finding> findings;
};

RigLamp lamps_of_rig(const std::string& name) {
  Rig rig = read_rig(name);
  RigLamp out;
  out.truth = rig.truth;
  out.bench = with_lamps(merge_session(rig.session), rig.board, rig.sent, rig.true_poses, out.findings);
  return out;
}

TEST(WithLamps, CleanBenchWithinAMillimeter) {
  BURIN_NEEDS_RIG("a");
  const RigLamp rig = lamps_of_rig("a");
  ASSERT_EQ(rig.bench.lights.size(), 1U);
  const Light& lamp = rig.bench.lights[0];
  const double error = (lamp.position_mm - true_lamp_position(rig.truth)).norm();
  EXPECT_LT(error, 1.0);
  EXPECT_EQ(lamp.falloff_exponent, 0);  // a bare lamp is not taken for a spot
  EXPECT_NEAR(rig.bench.material.base_alpha, rig.truth["material"]["base_alpha"].get<double>(), 0.001);
  EXPECT_TRUE(rig.bench.verdict.at(parameter::light_position("lamp")).determined());
}

// Paper along the rim and the plain face, seen from six places; the face of each view's photo as rough as `rough` says.
std::vector<LightSample> made_up_samples(const Board& board, const std::vector<double>& rough) {
  const LampModel<double> lamp{{-60, 180, 420}, std::log(4e5), {0, 0}, 0};
  std::vector<LightSample> samples;
  const auto add = [&](SampleKind kind, std::size_t view, const Eigen::Vector3d& p, const Eigen::Vector3d& camera) {
    LightSample s;
    s.kind = kind;
    s.light_view = view;
    s.p_board = p;
    s.to_camera = (camera - p).normalized();
    constexpr std::array<double, 2> kNoGrain{0, 0};
    s.value = kind == SampleKind::face
                  ? face_radiance(lamp, 0.01, rough[view], kNoGrain.data(), board.material.f0.mean(), s)
                  : paper_radiance(lamp, 0.01, paper_albedo(board, kind), s);
    s.sigma = 0.001 * s.value;
    s.tag = static_cast<int>(p.x()) + 1000 * static_cast<int>(p.y());
    samples.push_back(s);
  };
  for (std::size_t view = 0; view < rough.size(); ++view) {
    const double turn = 2 * std::numbers::pi * static_cast<double>(view) / static_cast<double>(rough.size());
    const Eigen::Vector3d camera(180 + 60 * std::cos(turn), -90 + 60 * std::sin(turn),
                                 430);  // about the mirror's place
    for (int x = 10; x < 120; x += 20)
      for (int y = 10; y < 100; y += 20) {
        const bool rim = x < 20 || x > 100 || y < 20 || y > 80;
        if (rim) add(SampleKind::white_paper, view, {x + 0.5, y + 0.5, 0}, camera);
        if (rim) add(SampleKind::black_paper, view, {x + 0.5, y + 0.5, 0}, camera);
        for (int i = 0; i < 4 && !rim; ++i) add(SampleKind::face, view, {x + 5. * i, y + 3. * i, 0}, camera);
      }
  }
  return samples;
}

// A face that is not the same in all photos (streaks, a lobe that is not GGX) is not known as well as its pixels are
// many.
TEST(FitLamps, ARoughnessThatPhotosDoNotAgreeOnHasASigmaThatSaysSo) {
  Board board;
  board.size_mm = {120, 100};
  board.material.f0.setConstant(0.92);
  board.material.base_alpha = 0.15;
  Bench bench;
  bench.lights.resize(1);
  bench.lights[0].id = "lamp";
  LampOptions options;
  options.jackknife = true;
  const double rough = 0.13;
  const LampSeed same = fit_lamps(made_up_samples(board, std::vector<double>(6, rough)), board, bench, options);
  ASSERT_TRUE(same.found);
  EXPECT_NEAR(same.base_alpha, rough, 1e-4);
  std::vector<double> of_photos;
  for (const double percent : {2.0, -1.0, 1.0, -2.0, 1.5, -1.5}) of_photos.push_back(rough * (1 + percent / 100));
  const LampSeed seed = fit_lamps(made_up_samples(board, of_photos), board, bench, options);
  ASSERT_TRUE(seed.found);
  EXPECT_LT(std::abs(seed.base_alpha - rough), 2.5 * seed.base_alpha_sigma);
  // Six photos that differ by 1.8 % tell their mean to 0.7 %.
  EXPECT_GT(seed.base_alpha_sigma, 0.0035 * rough);
  EXPECT_LT(seed.base_alpha_sigma, 0.02 * rough);
  options.jackknife = false;
  EXPECT_LT(fit_lamps(made_up_samples(board, of_photos), board, bench, options).base_alpha_sigma,
            0.5 * seed.base_alpha_sigma);
}

class SpotInAnAmateursRoom : public testing::TestWithParam<const char*> {};
TEST_P(SpotInAnAmateursRoom, IsFound) {
  BURIN_NEEDS_RIG(GetParam());
  const RigLamp rig = lamps_of_rig(GetParam());
  ASSERT_EQ(rig.bench.lights.size(), 1U);
  const Light& lamp = rig.bench.lights[0];
  EXPECT_LT((lamp.position_mm - true_lamp_position(rig.truth)).norm(), 3.0);
  // And no further off than it says: with errors counted as independent it was 3.1 sigmas on b-small.
  ASSERT_TRUE(lamp.position_sigma_mm.has_value());
  for (int i = 0; i < 3; ++i)
    EXPECT_LT(std::abs(lamp.position_mm[i] - true_lamp_position(rig.truth)[i]), 2.5 * (*lamp.position_sigma_mm)[i]);
  EXPECT_NEAR(lamp.falloff_exponent, 9, 1);
  const Eigen::Vector3d axis(rig.truth["lights"][0]["axis"][0].get<double>(),
                             rig.truth["lights"][0]["axis"][1].get<double>(),
                             rig.truth["lights"][0]["axis"][2].get<double>());
  EXPECT_LT(std::acos(lamp.axis.normalized().dot(axis.normalized())) * 180 / std::numbers::pi, 2.0);
}
INSTANTIATE_TEST_SUITE_P(Rigs, SpotInAnAmateursRoom, testing::Values("b-small", "b"), places::as_test_name);

TEST(Binned, KeepsPlacesAndMeans) {
  // A ramp: the mean of a binned pixel is the ramp at its center, and the scaled lens sees the same direction there.
  LightView view;
  view.lens.model = "LENSMODEL_PINHOLE";
  view.lens.intrinsics = {500, 510, 31.5, 20.25};
  view.lens.width = 64;
  view.lens.height = 48;
  view.window = {5, 7, 40, 30};
  view.value = Image(40, 30, 1);
  view.sigma = Image(40, 30, 1, 0.1F);
  view.valid.assign(40 * 30, 1);
  for (int y = 0; y < 30; ++y)
    for (int x = 0; x < 40; ++x) view.value.at(x, y) = static_cast<float>(3 * (x + 5) + 2 * (y + 7));
  const LightView half = binned(view, 3);
  for (int y = 0; y < half.window.height; ++y)
    for (int x = 0; x < half.window.width; ++x) {
      const double px = 3.0 * (x + half.window.x0) + 1, py = 3.0 * (y + half.window.y0) + 1;
      EXPECT_NEAR(half.value.at(x, y), 3 * px + 2 * py, 1e-3);
      EXPECT_NEAR((x + half.window.x0 - half.lens.intrinsics[2]) / half.lens.intrinsics[0], (px - 31.5) / 500, 1e-12);
      EXPECT_NEAR((y + half.window.y0 - half.lens.intrinsics[3]) / half.lens.intrinsics[1], (py - 20.25) / 510, 1e-12);
    }
  EXPECT_NEAR(half.sigma.at(0, 0), 0.1 / 3, 1e-6);
}

TEST(Binned, RaysOfAllViewsServeEveryWindow) {
  for (const char* model : {"LENSMODEL_PINHOLE", "LENSMODEL_OPENCV4"}) {
    LightView view;
    view.lens.model = model;
    view.lens.intrinsics = {700, 690, 161, 118};
    if (view.lens.model == "LENSMODEL_OPENCV4") view.lens.intrinsics = {700, 690, 161, 118, -0.2, 0.1, 0.001, -0.002};
    view.lens.width = 320;
    view.lens.height = 240;
    view.window = {21, 17, 203, 151};
    view.value = view.sigma = Image(203, 151, 1);
    view.valid.assign(203 * 151, 1);
    const Surface surface{{60, 40}, {0.1, 0, 0.2}};
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.linear() = Eigen::AngleAxisd(std::numbers::pi - 0.3, Eigen::Vector3d::UnitX()).toRotationMatrix();
    T.translation() = Eigen::Vector3d(0, 0, 200) - T.linear() * Eigen::Vector3d(30, 20, 0);
    LightView shared = view;
    shared.rays = std::make_shared<const CornerRays>(corner_rays(view.lens, {10, 5, 300, 230}));
    for (const int twice : {1, 2})
      for (const int bin : {1, 3}) {
        const FootprintGrid own = grid_of(binned(binned(view, bin), twice), T, surface),
                            of_all = grid_of(binned(binned(shared, bin), twice), T, surface);
        ASSERT_EQ(own.corner_x_mm.size(), of_all.corner_x_mm.size());
        std::size_t on_board = 0;
        for (std::size_t i = 0; i < own.corner_x_mm.size(); ++i) {
          ASSERT_EQ(std::isnan(own.corner_x_mm[i]), std::isnan(of_all.corner_x_mm[i]));
          if (std::isnan(own.corner_x_mm[i])) continue;
          ++on_board;
          ASSERT_NEAR(own.corner_x_mm[i], of_all.corner_x_mm[i], 1e-7);
          ASSERT_NEAR(own.corner_y_mm[i], of_all.corner_y_mm[i], 1e-7);
        }
        EXPECT_GT(on_board, own.corner_x_mm.size() / 4);
      }
  }
}

}  // namespace
}  // namespace burin
