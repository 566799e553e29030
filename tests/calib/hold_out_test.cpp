// What is proved: folds are what a person asked for, and refused where too little is left; on synthetic corners the
// photos held out are predicted as well as their noise allows, and a photo that the board's model does not fit (a board
// bent further in that photo alone) shows itself, though its own fit hides part of it.
#include "burin/calib/hold_out.h"

#include <gtest/gtest.h>

#include <random>

#include "burin/base/error.h"
#include "burin/calib/verdict/candidate_photo.h"

namespace burin {
namespace {

const std::vector<std::string> kSix{"a", "b", "c", "d", "e", "f"};

TEST(HoldOutFolds, AreWhatWasAskedFor) {
  using Folds = std::vector<std::vector<std::string>>;
  EXPECT_EQ(hold_out_folds("b,e", kSix, 3), (Folds{{"b", "e"}}));
  EXPECT_EQ(hold_out_folds("all", kSix, 3).size(), 6U);
  EXPECT_EQ(hold_out_folds("3", kSix, 3), (Folds{{"a", "d"}, {"b", "e"}, {"c", "f"}}));
  EXPECT_EQ(hold_out_folds("0.34", kSix, 3), (Folds{{"b", "e"}}));
  EXPECT_EQ(hold_out_folds("", kSix, 3).size(), 4U);
  EXPECT_EQ(hold_out_folds("", {"a", "b", "c", "d"}, 3).size(), 4U);  // one at a time, so that three stay
}

TEST(HoldOutFolds, RefusesWhatLeavesTooLittle) {
  EXPECT_THROW(hold_out_folds("g", kSix, 3), Error);
  EXPECT_THROW(hold_out_folds("a,b,c,d", kSix, 3), Error);
  EXPECT_THROW(hold_out_folds("0.9", kSix, 3), Error);
  EXPECT_THROW(hold_out_folds("7", kSix, 3), Error);
  EXPECT_THROW(hold_out_folds("2.5", kSix, 3), Error);
  EXPECT_THROW(hold_out_folds("", {"a", "b", "c"}, 3), Error);
}

struct HeldOutWorld {
  Board board;
  Lens lens;
  std::vector<ViewTags> pictures;
};

// Ten views of 12 tags, corners with 0.03 px of noise; in view `bent`, the board's middle stands up by `bow_mm`.
HeldOutWorld photograph(int bent, double bow_mm) {
  HeldOutWorld w;
  w.board.size_mm << 200, 200;
  w.board.tags.sigma_mm = 0.1;
  for (int i = 0; i < 12; ++i) {
    const double at = 15 + 170.0 * (i % 4) / 3;
    w.board.tags.list.push_back({i, {at, i / 4 == 0 ? 15 : i / 4 == 1 ? 100 : 185}, 16, 0});
  }
  w.lens.model = "LENSMODEL_OPENCV4";
  w.lens.width = 1600;
  w.lens.height = 1200;
  w.lens.intrinsics = {2400, 2400, 805, 590, 0, 0, 0, 0};
  const auto places = camera_places(w.board, w.lens, true);
  std::mt19937_64 random(8);
  std::normal_distribution<double> gauss;
  constexpr double kNoise_px = 0.03;
  for (int v = 0; v < 10; ++v) {
    Bundle bundle;
    bundle.lens = w.lens;
    bundle.surface.size_mm = w.board.size_mm;
    if (v == bent) bundle.surface.bow_mm << bow_mm, 0, bow_mm;
    bundle.tags.resize(w.board.tags.list.size());
    append_candidates(bundle, w.board, {places[static_cast<std::size_t>(10 * v + 1)]}, kNoise_px);
    ViewTags picture{"v" + std::to_string(v), "v" + std::to_string(v) + ".png", {}, {}};
    for (std::size_t i = 0; i + 3 < bundle.corners.size(); i += 4) {
      TagDetection tag;
      tag.id = w.board.tags.list[static_cast<std::size_t>(bundle.corners[i].tag)].id;
      for (std::size_t k = 0; k < 4; ++k) {
        tag.corner_px[k] = bundle.corners[i + k].q_px + kNoise_px * Eigen::Vector2d(gauss(random), gauss(random));
        tag.coarse_px[k] = tag.corner_px[k];
        tag.corner_sigma_px[k] = kNoise_px;
      }
      picture.tags.push_back(tag);
    }
    w.pictures.push_back(picture);
  }
  return w;
}

TEST(HoldOutCorners, ArePredictedAsWellAsTheirNoiseAllows) {
  const HeldOutWorld w = photograph(-1, 0);
  const BoardSolution s = solve_board(w.board, w.pictures, w.lens.width, w.lens.height);
  std::vector<std::string> names;
  for (const View& view : s.views) names.push_back(view.name);
  ASSERT_EQ(names.size(), 10U);
  const HeldOutCorners held = hold_out_corners(s, w.board, w.pictures, hold_out_folds("5", names, 3));
  ASSERT_EQ(held.views.size(), 10U);
  EXPECT_GT(held.held_out_rms_px, held.fit_rms_px);
  EXPECT_NEAR(held.held_out_rms_px / held.expected_rms_px, 1, 0.1);  // lens and tags of eight views are nearly exact
  EXPECT_NEAR(held.fit_rms_px, 0.03, 0.005);
}

TEST(HoldOutCorners, ShowAPhotoThatTheModelDoesNotFit) {
  const HeldOutWorld w = photograph(4, 0.25);
  const BoardSolution s = solve_board(w.board, w.pictures, w.lens.width, w.lens.height);
  std::vector<std::string> names;
  for (const View& view : s.views) names.push_back(view.name);
  const HeldOutCorners held = hold_out_corners(s, w.board, w.pictures, hold_out_folds("v4", names, 3));
  ASSERT_EQ(held.views.size(), 1U);
  EXPECT_GT(held.views[0].held_out_rms_px, 1.5 * held.views[0].expected_rms_px);
}

}  // namespace
}  // namespace burin
