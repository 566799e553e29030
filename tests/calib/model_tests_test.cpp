// What is proved, on photos predicted from known grooves: where they obey the model no test finds a misfit; a camera
// that bends what it sees is found out, and the sigmas then reach to the truth; a lamp with a size is chosen where
// there is one and not where there is none, with its radius and the roughness; a photo that another lamp shines into is
// named; numbers beyond their bounds end on them.
// Not proved: that every effect is found.
#include "burin/calib/verdict/model_tests.h"

#include <gtest/gtest.h>

#include <cmath>

#include "burin/calib/photo/field_choice.h"
#include "burin/calib/verdict/odd_photos.h"
#include "burin/calib/verdict/photo_uncertainty.h"
#include "burin/calib/verdict/refine_result.h"
#include "tests/calib/fitted_grooves.h"

namespace burin {
namespace {

Uncertainty uncertainty_of(FittedGrooves& f) {
  f.s.data.size_sought = {false};
  return uncertainty_of(f.s.data, f.stage, f.state);
}

TEST(ModelTests, FindNothingWhereTheModelHolds) {
  FittedGrooves f;
  fit_small_grooves(0, 1, f);
  EXPECT_TRUE(uncertainty_of(f).misfits.empty());
}

TEST(ModelTests, FindACameraThatBendsWhatItSees) {
  FittedGrooves straight, f;
  fit_small_grooves(0, 1, straight);
  fit_small_grooves(0, 0.85, f);
  const Uncertainty u = uncertainty_of(f);
  EXPECT_FALSE(u.misfits.empty());
  for (const Misfit& m : u.misfits) {
    EXPECT_EQ(m.classes.size(), static_cast<std::size_t>(kQuantityBins));
    EXPECT_FALSE(quantity_in_words(m).empty());
    EXPECT_FALSE(remedy_in_words(m).empty());
  }
  // What the misfit moves is in the sigma: the answer is no further off than four of them.
  const double off = std::abs(f.state.shared[unknown::log_alpha] - f.s.truth.shared[unknown::log_alpha]);
  EXPECT_GT(off, 4 * uncertainty_of(straight).sigma(unknown::log_alpha));
  EXPECT_LT(off, 4 * u.sigma(unknown::log_alpha));
}

// Misfits of single photos, as judge() asks for them.
std::vector<Misfit> odd_photos(FittedGrooves& f) {
  Uncertainty u = uncertainty_of(f);
  u.misfits.clear();
  const Carved carved = carved_at(f.s.data.model, f.state.of(0));
  std::vector<PhotoFit> photos;
  for (std::size_t k = 0; k < f.s.data.photos.size(); ++k)
    photos.push_back(photo_fit(f.s.data, k, f.state, carved, f.s.bench));
  const std::size_t shifts = u.shifts.size();
  add_odd_photos(photos, u);
  EXPECT_EQ(u.shifts.size() - shifts, u.misfits.size());
  return u.misfits;
}

TEST(OddPhotos, OneThatAnotherLampShinesIntoIsNamedAndNoOther) {
  FittedGrooves clean, stray;
  fit_small_grooves(0, 1, clean);
  EXPECT_TRUE(odd_photos(clean).empty());
  fit_small_grooves(0, 1, stray, 0.1);
  const std::vector<Misfit> found = odd_photos(stray);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found.front().test, "photo " + stray.s.bench.views[stray.s.data.photos.back().photo.view].name);
  EXPECT_EQ(found.front().classes.size(), 6U);
}

// Rig f, far from the fit's end: one of its own photos seemed to show other grooves. At the end it fits as the others.
TEST(OddPhotos, APhotoThatFitsAtTheEndIsNotOfAnotherBoard) {
  const auto photo = [](const char* view, double residual_to_noise) {
    return PhotoFit{view, "lamp", 9000, 0.03, residual_to_noise, 0.01};
  };
  const std::vector<PhotoFit> photos{photo("v00", 1.0), photo("v01", 1.05), photo("v01", 1.6),
                                     photo("v02", 1.1), photo("v03", 6.0),  photo("v04", 0.9)};
  for (const char* own : {"v00", "v01", "v02", "v04"}) EXPECT_TRUE(fits_as_usual(photos, own)) << own;
  EXPECT_FALSE(fits_as_usual(photos, "v03"));
  EXPECT_FALSE(fits_as_usual({}, "v00"));
}

TEST(LampSize, ADiskIsChosenWhereThereIsOneAndNotWhereThereIsNone) {
  constexpr double kRadiusMm = 18;  // a 12th of the lamp's distance
  for (const double disk_mm : {0., kRadiusMm}) {
    FittedGrooves f;
    fit_small_grooves(disk_mm, 1, f);
    const FreeField choice = choose_depth_field(f.s.data, f.stage, f.state);
    EXPECT_EQ(choice.size, disk_mm > 0);
    EXPECT_FALSE(choice.linear || choice.quadratic || choice.wear);
    if (!choice.size) continue;
    f.stage.free(choice);
    solve(f.s.data, f.stage, 12, 1e-8, f.state, {}, "");
    EXPECT_NEAR(size_unit_mm(f.s.board) * std::sqrt(f.state.block(unknown::size2)[0]), kRadiusMm, 1.5);
    EXPECT_NEAR(f.state.shared[unknown::log_alpha], f.s.truth.shared[unknown::log_alpha], 0.01);
  }
}

// Each hides the other: asked for alone, neither is believed.
TEST(LampSize, ADiskIsChosenBesideGlareThatHidesIt) {
  constexpr double kSmallDisk_mm = 7, kGlare = 0.01;
  FittedGrooves f;
  fit_small_grooves(kSmallDisk_mm, 1, f, 0, kGlare);
  const FreeField choice = choose_depth_field(f.s.data, f.stage, f.state);
  EXPECT_TRUE(choice.size);
  f.stage.free(choice);
  solve(f.s.data, f.stage, 12, 1e-8, f.state, {}, "");
  EXPECT_NEAR(f.state.shared[unknown::log_alpha], f.s.truth.shared[unknown::log_alpha], 0.01);
}

TEST(Bounds, AStepBeyondThemEndsOnThem) {
  FittedGrooves f;
  fit_small_grooves(0, 1, f);
  f.state.shared[unknown::log_alpha] = 12.6;  // "alpha is 302111"
  f.state.shared[unknown::log_base_alpha] = std::nan("");
  keep_within_bounds(f.s.data, f.state);
  EXPECT_LE(std::exp(f.state.shared[unknown::log_alpha]), 0.8 + 1e-9);
  EXPECT_TRUE(std::isfinite(f.state.shared[unknown::log_base_alpha]));
}

}  // namespace
}  // namespace burin
