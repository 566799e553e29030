// What is proved: on photographed benches that brute force rendered (point sampling, lens blur, noise, JPEG, dust),
// with true poses so that only this fit is on trial: alpha, depth, lamp and machine, from photos binned to 1.6 mm a
// pixel to be quick; that a session whose half vectors never reach the grooves' cut-off reports depth as not
// determined; that a session without photos to work on is refused. Not proved: poses from tags (calibrate_test), full
// resolution (`burin refine` on the rigs).
#include "burin/calib/refine.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "burin/base/error.h"
#include "burin/base/files/decimals.h"
#include "burin/calib/verdict/refine_result.h"
#include "tests/calib/rig_bench.h"
#include "tests/calib/small_grooves.h"

namespace burin {
namespace {

RefineOptions quick() {
  RefineOptions options;
  options.finest_pixel_mm = 1.6;
  return options;
}

// Within four sigmas of what refine says of itself.
void expect_within_its_sigmas(const Bench& bench, const nlohmann::json& truth) {
  const auto expect_near = [](double value, double expected, std::optional<double> sigma, const std::string& name) {
    ASSERT_TRUE(sigma.has_value()) << name;
    EXPECT_NEAR(value, expected, 4 * *sigma) << name;
  };
  const nlohmann::json& material = truth["material"];
  expect_near(bench.material.alpha, material["alpha"], bench.material_sigma.alpha, "alpha");
  expect_near(bench.material.depth_um, material["depth_um"], bench.material_sigma.depth_um, "depth_um");
  expect_near(bench.material.base_alpha, material["base_alpha"], bench.material_sigma.base_alpha, "base_alpha");
  const Light& lamp = bench.lights[0];
  ASSERT_TRUE(lamp.position_sigma_mm && bench.machine_affine_sigma);
  for (int i = 0; i < 3; ++i)
    expect_near(lamp.position_mm[i], true_lamp_position(truth)[i], (*lamp.position_sigma_mm)[i],
                "lamp, axis " + std::to_string(i));
  for (int row = 0; row < 2; ++row)
    for (int column = 0; column < 3; ++column)
      expect_near(bench.machine_affine(row, column), true_affine(truth)(row, column),
                  (*bench.machine_affine_sigma)(row, column),
                  "machine, row " + std::to_string(row) + ", column " + std::to_string(column));
  const auto sigma_of = [](const std::optional<Eigen::Vector3d>& sigma, int i) {
    return sigma ? std::optional((*sigma)[i]) : std::nullopt;
  };
  for (int i = 0; i < 3; ++i)
    expect_near(bench.sensor.vignette[i], truth.contains("vignette") ? truth["vignette"][i].get<double>() : 0,
                sigma_of(bench.sensor.vignette_sigma, i), "vignette " + std::to_string(i));
  double ambient = 0;  // the mean of its channels is what is measured
  for (const double channel : truth["ambient"]) ambient += channel * truth["sensor"]["gain"].get<double>() / 3;
  expect_near(bench.ambient.mean(), ambient, sigma_of(bench.ambient_sigma, 0), "ambient");
  ASSERT_TRUE(bench.sensor.psf_sigma_sigma_px);
  EXPECT_LT(*bench.sensor.psf_sigma_sigma_px, 0.2 * bench.sensor.psf_sigma_px);
}

TEST(Refine, CleanBench) {
  BURIN_NEEDS_RIG("a");
  const Rig rig = read_rig("a", {"v01", "v04", "v06", "v08", "v10"});
  RefineOptions options = quick();
  options.crossings = Crossings::add;
  const Refinement r = refine(rig.session, rig.board, rig.sent, rig.true_poses, options);
  expect_within_its_sigmas(r.bench, rig.truth);
  // And whatever the sigmas, should they grow. Measured: alpha off by 0.03 %, depth by 0.02 %, the lamp by 0.05 mm, the
  // map by 0.001 mm. Far above that, and far below what was believed (alpha 0.04, depth 10 um).
  const auto& truth = rig.truth["material"];
  EXPECT_NEAR(r.bench.material.alpha / truth["alpha"].get<double>(), 1, 0.01);
  EXPECT_NEAR(r.bench.material.depth_um / truth["depth_um"].get<double>(), 1, 0.015);
  EXPECT_NEAR(r.bench.material.base_alpha / truth["base_alpha"].get<double>(), 1, 0.01);
  EXPECT_LT((r.bench.lights[0].position_mm - true_lamp_position(rig.truth)).norm(), 1.5);
  EXPECT_LT(affine_error_mm(r.bench.machine_affine, true_affine(rig.truth), rig.board), 0.01);
  for (const char* name : {"alpha", "depth_um", "base_alpha", "light.lamp.position_mm", "machine.affine"})
    EXPECT_TRUE(r.bench.verdict.at(name).determined()) << name << ": " << sentence(r.bench.verdict.at(name));
  ASSERT_TRUE(r.bench.material_sigma.depth_um.has_value());
  EXPECT_TRUE(r.bench.depth_field.is_constant());  // one depth and one roughness everywhere: no field is made up
  EXPECT_TRUE(r.bench.alpha_field.is_constant());
  ASSERT_EQ(r.photos.size(), 5U);
  for (const PhotoFit& photo : r.photos) EXPECT_LT(photo.outliers, 0.1) << photo.view;
}

// By covariances that are known: of two estimates the wider one counts, and a shift adds to it.
TEST(Refine, CorrelationsAreThoseOfTheWiderEstimate) {
  SmallGrooves s;
  fill_small_grooves(s, 3);
  const int alpha = unknown::log_alpha, depth = unknown::log_depth, z = global_index(unknown::lamp_position + 2, 0);
  const Eigen::Index n = global_count(1);
  Eigen::MatrixXd narrow = Eigen::MatrixXd::Identity(n, n), wide = 4 * narrow;
  narrow(alpha, depth) = narrow(depth, alpha) = 0.9;
  wide(alpha, depth) = wide(depth, alpha) = -2;
  wide(alpha, z) = wide(z, alpha) = 1;
  Uncertainty uncertainty;
  uncertainty.covariances = {narrow, wide};
  s.bench.material_sigma.alpha = 0.1;
  s.bench.material_sigma.depth_um = 0.2;
  s.bench.material_sigma.base_alpha = 0.3;  // has a sigma, but no verdict
  s.bench.lights[0].id = "lamp";
  s.bench.lights[0].position_sigma_mm = Eigen::Vector3d(1, 2, 3);
  for (const char* name : {"alpha", "depth_um", "light.lamp.position_mm"})
    s.bench.verdict[name].degree = Degree::determined;
  const Correlations known = correlations_of(s.data, uncertainty, s.bench);
  ASSERT_EQ(known.numbers.size(), 5U);
  EXPECT_EQ(known.numbers[4].name, "light.lamp.position_mm[2]");
  EXPECT_EQ(known.numbers[4].unit, "mm");
  EXPECT_EQ(known.numbers[4].sigma, 3);
  EXPECT_NEAR(known.values(0, 1), -0.5, 1e-12);
  EXPECT_NEAR(known.values(4, 0), 0.25, 1e-12);
  EXPECT_NEAR(known.values(1, 4), 0, 1e-12);
  uncertainty.shifts.emplace_back(Eigen::VectorXd::Zero(n));
  uncertainty.shifts.back()[alpha] = uncertainty.shifts.back()[depth] = 2;
  EXPECT_NEAR(correlations_of(s.data, uncertainty, s.bench).values(0, 1), 0.25, 1e-12);  // (4 - 2) / (4 + 4)
}

class RefineAmateursBench : public testing::TestWithParam<const char*> {};
TEST_P(RefineAmateursBench, ComesOut) {
  BURIN_NEEDS_RIG(GetParam());
  const Rig rig = read_rig(GetParam(), {"v01", "v03", "v05", "v07", "v09"});
  const Refinement r = refine(rig.session, rig.board, rig.sent, rig.true_poses, quick());
  expect_within_its_sigmas(r.bench, rig.truth);
  const auto& truth = rig.truth["material"];
  EXPECT_EQ(r.bench.crossings, Crossings::last);  // its grooves cut into each other, and the photos say so
  // And whatever the sigmas. Measured: alpha off by 0.7 and 0.3 %, depth by 0 and 0.2 %, the lamp by 4.1 and 2.2 mm,
  // the map by at most 0.005 mm. Far below what was believed (alpha 0.04, depth 12 um).
  EXPECT_NEAR(r.bench.material.alpha / truth["alpha"].get<double>(), 1, 0.06);
  EXPECT_NEAR(r.bench.material.depth_um / truth["depth_um"].get<double>(), 1, 0.05);
  EXPECT_LT((r.bench.lights[0].position_mm - true_lamp_position(rig.truth)).norm(), 10);
  EXPECT_LT(affine_error_mm(r.bench.machine_affine, true_affine(rig.truth), rig.board), 0.03);
  // Four sigmas of its own, which must be small enough to tell 7 from 4 %.
  ASSERT_TRUE(r.bench.depth_field.sigma.has_value());
  for (const auto& [term, expected] : {std::pair(0, 0.07), {1, -0.04}}) {
    const double sigma = (*r.bench.depth_field.sigma)[term];
    EXPECT_LT(sigma, 0.02) << term;
    EXPECT_NEAR(r.bench.depth_field.terms[term], expected, 4 * sigma) << term;
  }
  const Correlations& all = r.correlations;
  ASSERT_EQ(all.numbers.size(), 12U);  // groove and face, the map, the lamp
  EXPECT_EQ(all.numbers[1].name, "depth_um");
  EXPECT_EQ(all.numbers[1].sigma, r.bench.material_sigma.depth_um);
  EXPECT_EQ(all.numbers[11].name, "light.lamp.position_mm[2]");
  EXPECT_LT((all.values.diagonal().array() - 1).abs().maxCoeff(), 1e-9);
  EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(all.values).eigenvalues()[0], -1e-9);
  // The lamp's light on the paper fixes its direction better than its distance: y and z move along it.
  const Eigen::Vector3d lamp = true_lamp_position(rig.truth);
  EXPECT_GT(all.values(10, 11) * lamp.y() * lamp.z(), 0);
  // The lamp's color: ratios of its channels.
  const Eigen::Vector3d color = r.bench.lights[0].intensity / r.bench.lights[0].intensity[0];
  EXPECT_NEAR(color[1], 600. / 620., 0.02);
  EXPECT_NEAR(color[2], 555. / 620., 0.02);
}
INSTANTIATE_TEST_SUITE_P(Rigs, RefineAmateursBench, testing::Values("b-small", "b"), places::as_test_name);

TEST(Refine, DepthIsNotDeterminedWhereNoHalfVectorReachesTheCutOff) {
  BURIN_NEEDS_RIG("a");
  // Only the mirror side: the half vectors stay near the face's normal, every scratch that could glint does.
  Rig rig = read_rig("a", {"v00", "v01", "v02"});
  rig.board.material.depth_um = 0.99 * rig.truth["material"]["depth_um"].get<double>();
  RefineOptions options = quick();
  options.crossings = Crossings::add;
  const Refinement r = refine(rig.session, rig.board, rig.sent, rig.true_poses, options);
  const Verdict& depth = r.bench.verdict.at("depth_um");
  EXPECT_FALSE(depth.known()) << sentence(depth);
  EXPECT_TRUE(rests_on(depth, Cause::Kind::cutoff_not_seen));
  EXPECT_FALSE(r.bench.material_sigma.depth_um.has_value());
  // It stays what was believed, not what the optimizer strayed to, and is called so.
  EXPECT_EQ(r.bench.material.depth_um, rig.board.material.depth_um);
  EXPECT_EQ(depth.source, Source::assumed);
  EXPECT_EQ(sentence(depth).rfind("left as it was believed", 0), 0U) << sentence(depth);
  EXPECT_EQ(r.bench.told.depth_um, rig.board.material.depth_um);
  EXPECT_NE(sentence(depth).find("photograph"), std::string::npos);  // it says what to do
}

TEST(Refine, ADepthThatPhotosSpeakAgainstIsNotGoneBackTo) {
  BURIN_NEEDS_RIG("a");
  // The same photos; but the board is believed to be so shallow that what glints in them should not.
  const Rig rig = read_rig("a", {"v00", "v01", "v02"});
  const double true_um = rig.truth["material"]["depth_um"], believed_um = rig.board.material.depth_um;
  ASSERT_LT(believed_um, 0.75 * true_um);
  RefineOptions options = quick();
  options.crossings = Crossings::add;
  const Refinement r = refine(rig.session, rig.board, rig.sent, rig.true_poses, options);
  const Verdict& depth = r.bench.verdict.at("depth_um");
  EXPECT_FALSE(depth.known()) << sentence(depth);
  ASSERT_TRUE(rests_on(depth, Cause::Kind::believed_refuted)) << sentence(depth);
  EXPECT_EQ(depth.source, Source::measured);
  EXPECT_NEAR(r.bench.material.depth_um, true_um, 0.03 * true_um);  // measured: 13.99 um of 14
  EXPECT_FALSE(r.bench.material_sigma.depth_um.has_value());
  EXPECT_NE(sentence(depth).find("contradict the prior of " + significant(believed_um, 3)), std::string::npos);
}

// Photos of a board whose tags fit, and whose grooves are others: here the same scratches on the other side of the
// board, and all of them a centimeter aside.
TEST(Refine, RefusesPhotosOfOtherGrooves) {
  const Rig rig = read_rig("b-small", {"v01", "v03", "v05", "v07", "v09"});
  const Scratches own = rig.sent.scratches;
  Scratches mirrored = own, aside = own;
  const double width = rig.board.size_mm.x();
  for (std::size_t i = 0; i < own.size(); ++i) {
    mirrored.x0_mm[i] = width - own.x0_mm[i];
    mirrored.x1_mm[i] = width - own.x1_mm[i];
    aside.y0_mm[i] += 10;
    aside.y1_mm[i] += 10;
  }
  for (const Scratches& other : {mirrored, aside}) try {
      refine(rig.session, rig.board, Sent(other), rig.true_poses, quick());
      ADD_FAILURE() << "measured grooves that are not there";
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find("the grooves in the photos are not the ones that it lists"),
                std::string::npos)
          << error.what();
    }
}

// `rig`'s photos, those of some views turned about, so that their grooves lie elsewhere.
std::vector<MergedView> with_turned_views(const Rig& rig, const std::vector<std::string>& turned) {
  std::vector<MergedView> merged = photos_for_refine(rig.session, rig.board, rig.true_poses);
  for (MergedView& view : merged) {
    if (std::find(turned.begin(), turned.end(), view.view) == turned.end()) continue;
    std::reverse(view.value.data.begin(), view.value.data.end());
    std::reverse(view.sigma.data.begin(), view.sigma.data.end());
    std::reverse(view.valid.begin(), view.valid.end());
  }
  return merged;
}

std::string all_findings(const Refinement& refinement) {
  std::string found;
  for (const Finding& finding : refinement.findings) found += sentence(finding) + "\n";
  return found;
}

// One photo of another board among good ones.
TEST(Refine, NamesTheViewThatShowsOtherGrooves) {
  const Rig rig = read_rig("b-small", {"v01", "v03", "v05", "v07", "v09"});
  const std::string found =
      all_findings(refine(with_turned_views(rig, {"v05"}), rig.board, rig.sent, rig.true_poses, quick()));
  EXPECT_NE(found.find("view v05 shows other grooves"), std::string::npos) << found;
}

// What one moment explains is told once.
TEST(Refine, ViewsThatOneMomentSetsApartAreOneFinding) {
  const Rig rig = read_rig("b-small", {"v00", "v01", "v03", "v05", "v07", "v09"});
  RefineOptions options = quick();
  options.session = &rig.session;
  const std::string found =
      all_findings(refine(with_turned_views(rig, {"v07", "v09"}), rig.board, rig.sent, rig.true_poses, options));
  EXPECT_NE(found.find("the lamp was moved between IMG_"), std::string::npos) << found;
  EXPECT_NE(found.find("views v07, v09"), std::string::npos) << found;
  EXPECT_EQ(found.find("other grooves"), std::string::npos) << found;
}

TEST(Refine, RefusesWhatItCannotWorkOn) {
  Board board;
  board.size_mm << 100, 100;
  board.carve_max_mm << 100, 100;
  Scratches one;
  one.x0_mm = {10};
  one.y0_mm = {10};
  one.x1_mm = {20};
  one.y1_mm = {10};
  const std::vector<MergedView> none;
  EXPECT_THROW(refine(none, board, {}, Bench()), Error);
  EXPECT_THROW(refine(none, board, Sent(one), Bench()), Error);
}

}  // namespace
}  // namespace burin
