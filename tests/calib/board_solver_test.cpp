// Poses, lens, bow and tags from tags: photographed benches against their truth, and synthetic ones against their
// predicted uncertainty.
#include "calib/board_solver.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <random>

#include "render/error.h"
#include "tests/calib/rig_truth.h"

namespace burin {
namespace {

namespace fs = std::filesystem;
const fs::path kShared = BURIN_SHARED_DIR;

struct Rig {
  RigTruth truth;
  Board board;
  std::vector<ViewTags> pictures;
};

Rig detect_rig(const fs::path& folder) {
  Rig rig{read_rig_truth(folder), read_board(folder / "board.json"), {}};
  TagDetector detector(rig.board.tags.family);
  std::vector<int> ids;
  for (const Tag& tag : rig.board.tags.list) ids.push_back(tag.id);
  for (const auto& view : rig.truth.views) {
    const RigPhoto photo = merge_for_test(folder, rig.truth, view);
    rig.pictures.push_back({view.name, view.photos[0].file, detector.detect(photo.linear, photo.valid, ids).tags});
  }
  return rig;
}

// Proves: on photographs of a bench with known truth, camera centres come out within issue 4's figure (0.15 mm RMS on
// the clean bench, 0.5 mm on the amateur's), and errors are of the size that the covariance says.
class BoardOfRig : public testing::TestWithParam<std::tuple<const char*, double, double>> {};
TEST_P(BoardOfRig, CamerasAreWhereTheyWere) {
  const auto [name, bound_mm, bound_px] = GetParam();
  const fs::path folder = kShared / "rigs" / name;
  if (!fs::exists(folder / "truth.json")) GTEST_SKIP() << folder << " is missing";
  const Rig rig = detect_rig(folder);
  const BoardSolution s = solve_board(rig.board, rig.pictures, rig.truth.lens.width, rig.truth.lens.height);
  for (const Finding& f : s.findings) std::printf("  %s\n", sentence(f).c_str());
  ASSERT_EQ(s.views.size(), rig.truth.views.size());
  double sum2 = 0, normalised2 = 0;
  for (std::size_t v = 0; v < s.views.size(); ++v) {
    const Eigen::Vector3d e =
        s.views[v].T_camera_board.inverse().translation() - rig.truth.views[v].T_camera_board.inverse().translation();
    sum2 += e.squaredNorm();
    normalised2 += e.dot(s.center_covariance_mm2[v].ldlt().solve(e));
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
      "%s: centres %.3f mm RMS (in sigmas %.2f), corners %.4f px, f %.2f %.2f (true %.2f %.2f, sigma %.2f) %s\n", name,
      rms, std::sqrt(normalised2 / 3 / s.views.size()), s.rms_px, s.lens.intrinsics[0], s.lens.intrinsics[1],
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
  EXPECT_LT(std::sqrt(normalised2 / 3 / s.views.size()), 2);
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(s.bow_mm[i], rig.truth.surface.bow_mm[i], 3 * s.bow_sigma_mm[i] + 0.002);
  EXPECT_LT(s.check->max_shift_px, 0.01);
}
INSTANTIATE_TEST_SUITE_P(Rigs, BoardOfRig, testing::Values(std::tuple("a", 0.15, 0.02), std::tuple("b", 0.5, 0.06)),
                         [](const auto& info) { return std::string(std::get<0>(info.param)); });

}  // namespace
}  // namespace burin
