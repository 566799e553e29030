// What is proved: of grooves photographed under a spot and fitted with a bare lamp, photos ask for the spot, and lamp
// and fall-off come out as they were; of those under a bare lamp they do not, and nothing is moved. The photos are the
// model's own, with noise: that real misfits do not look like spots is scripts/random-benches' to show.
#include "burin/calib/photo/spot_choice.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "burin/calib/photo/photo_fit.h"
#include "burin/calib/photo/photo_weights.h"
#include "tests/calib/fitted_grooves.h"

namespace burin {
namespace {

constexpr double kAim_mm[2] = {36, 25};

// Photographed under a spot of that exponent (0: a bare lamp), fitted with a bare lamp.
void fit_with_bare_lamp(double exponent, FittedGrooves& out) {
  SmallGrooves& s = out.s;
  fill_small_grooves(s, 11);
  s.data.size_sought = {false};
  make_spot(s.board, exponent, s.truth.block(unknown::spot));
  if (exponent > 0) std::copy_n(kAim_mm, 2, s.truth.block(unknown::spot));
  std::mt19937_64 random(5);
  std::normal_distribution<float> normal;
  for (int k = 0; k < 6; ++k) {
    PhotoData photo = make_photo_data(add_view(s, k), 1, s.board, s.bench, 2);
    photo.photo.value = predict(s.data.model, photo, s.truth.of(0), carved_at(s.data.model, s.truth.of(0)));
    see_by_camera(1, random, normal, photo);
    s.data.photos.push_back(std::move(photo));
  }
  out.stage.free(Group::lamp).hold({Group::machine, Group::vignette, Group::blur});
  out.state = s.truth;
  make_spot(s.board, 0, out.state.block(unknown::spot));
  for (int round = 0; round < 2; ++round) {
    weigh_photos(s.data, out.state);
    solve(s.data, out.stage, 20, 1e-7, out.state, {}, "");
  }
}

double lamp_off_mm(const FittedGrooves& f) {
  return (Eigen::Vector3d::Map(f.state.block(unknown::lamp_position)) -
          Eigen::Vector3d::Map(f.s.truth.block(unknown::lamp_position)))
      .norm();
}

TEST(SpotChoice, SpotTakenForABareLampIsFound) {
  constexpr double kExponent = 4;
  FittedGrooves f;
  fit_with_bare_lamp(kExponent, f);
  const double bare_mm = lamp_off_mm(f);
  std::vector<Eigen::VectorXd> pointed_to;
  ASSERT_TRUE(choose_spots(f.stage, f.s.data, f.state, pointed_to, {}));
  EXPECT_TRUE(f.s.data.is_spot[0]);
  EXPECT_TRUE(pointed_to.empty());
  solve(f.s.data, f.stage, 50, 1e-9, f.state, {}, "");
  const double* const spot = f.state.block(unknown::spot);
  EXPECT_NEAR(spot[2], kExponent, 0.2);
  EXPECT_NEAR(spot[0], kAim_mm[0], 1);
  EXPECT_NEAR(spot[1], kAim_mm[1], 1);
  EXPECT_LT(lamp_off_mm(f), 0.3 * bare_mm);
}

TEST(SpotChoice, BareLampStaysOne) {
  FittedGrooves f;
  fit_with_bare_lamp(0, f);
  const State before = f.state;
  std::vector<Eigen::VectorXd> pointed_to;
  EXPECT_FALSE(choose_spots(f.stage, f.s.data, f.state, pointed_to, {}));
  EXPECT_FALSE(f.s.data.is_spot[0]);
  EXPECT_EQ(f.state.shared, before.shared);
  EXPECT_EQ(f.state.lamps, before.lamps);
}

}  // namespace
}  // namespace burin
