// Proves: odd photos that one moment parts from the others are one change; others are none. Of grooves: one photo of
// another board is named, many are all the photos' fault, and a fit that has not got far blames none.
#include "burin/calib/change_in_time.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "burin/calib/verdict/groove_agreement.h"
#include "tests/calib/small_grooves.h"

namespace burin {
namespace {

Session session_of(int views) {
  Session session;
  for (int v = 0; v < views; ++v)
    for (int k = 0; k < 2; ++k) {
      Photo photo;
      photo.view = "v" + std::to_string(v);
      photo.file = "photos/IMG_" + std::to_string(10 + 2 * v + k) + ".JPG";
      session.photos.push_back(photo);
    }
  return session;
}

TEST(ChangeInTime, OneMomentPartsOddPhotosFromTheOthers) {
  const Session session = session_of(8);
  const auto late = change_in_time(session, {"v5", "v6", "v7"});
  ASSERT_TRUE(late);
  EXPECT_EQ(late->photo_before, "IMG_19.JPG");
  EXPECT_EQ(late->photo_after, "IMG_20.JPG");
  EXPECT_TRUE(late->odd_after);
  const auto early = change_in_time(session, {"v1", "v0", "v3"}, {"v2"});
  ASSERT_TRUE(early) << "v2 may be of either side";
  EXPECT_EQ(early->photo_before, "IMG_17.JPG");
  EXPECT_FALSE(early->odd_after);
  EXPECT_FALSE(change_in_time(session, {"v1", "v0", "v3"})) << "v2 between them is as the others";
  EXPECT_FALSE(change_in_time(session, {"v0"})) << "one photo is no change";
  EXPECT_FALSE(change_in_time(session, {"v2", "v3"}));
}

// A lamp that was moved draws the fit towards itself: one of the views under it fits hardly worse than the others.
TEST(ChangeInTime, AMovedLampIsFoundThoughOneOfItsViewsFits) {
  const Session session = session_of(8);
  const std::vector<std::pair<std::string, double>> residuals{{"v0", 1.1}, {"v1", 1.0}, {"v2", 1.2}, {"v3", 1.05},
                                                              {"v4", 4.0}, {"v5", 1.4}, {"v6", 5.0}, {"v7", 4.5}};
  std::vector<std::string> odd{"v4", "v6", "v7"};
  const auto change = change_of_lamp(session, residuals, odd);
  ASSERT_TRUE(change);
  EXPECT_EQ(change->view_before, "v3");
  EXPECT_EQ(change->view_after, "v4");
  EXPECT_EQ(odd, (std::vector<std::string>{"v4", "v6", "v7", "v5"})) << "it is one of them";
  // Where a clean view would have to join before it, no moment is made up.
  std::vector<std::pair<std::string, double>> other = residuals;
  other[1].second = 2;
  odd = {"v4", "v6", "v7"};
  EXPECT_FALSE(change_of_lamp(session, other, odd));
  EXPECT_EQ(odd.size(), 3U);
  odd = {"v2", "v5"};  // here and there
  EXPECT_FALSE(change_of_lamp(session, residuals, odd));
}

TEST(GrooveAgreement, OnePhotoOfAnotherBoardIsNamedAndManyAreNotAFit) {
  const GrooveAgreement own{true, 0.9, 600}, other{true, 0.02, 600}, dark{false, 0, 1}, vague{true, 0.5, 600};
  EXPECT_TRUE(photos_of_other_grooves({own, own, own, dark}).empty());
  EXPECT_EQ(photos_of_other_grooves({own, own, other, own, dark}), std::vector<std::size_t>{2});
  EXPECT_EQ(photos_of_other_grooves({other, other, dark, other}), (std::vector<std::size_t>{0, 1, 3}));
  EXPECT_TRUE(photos_of_other_grooves({vague, vague, vague, other}).empty());
  EXPECT_TRUE(photos_of_other_grooves({other, other}).empty()) << "two photos are too few";
  // Grooves that faded in the fit: no photo tells by itself, all together do. Rig d's, with another rig's scratches.
  const GrooveAgreement faded{false, 0.03, 6}, dark_own{false, 0.9, 6}, nothing{false, 0.1, 0.5};
  EXPECT_EQ(photos_of_other_grooves({faded, faded, faded, faded}), (std::vector<std::size_t>{0, 1, 2, 3}));
  EXPECT_TRUE(photos_of_other_grooves({dark_own, dark_own, faded, dark_own}).empty());
  const GrooveAgreement poor{true, 0.37, 110};  // the worst of rig f's own, far from the fit's end
  EXPECT_TRUE(photos_of_other_grooves({own, own, poor, own}).empty());
  EXPECT_TRUE(photos_of_other_grooves({nothing, nothing, nothing}).empty());
}

// Photos whose pixels vary, of these grooves and of others of the same picture: each elsewhere by a millimeter or two.
// From afar both are the same board.
// Grooves at the same places with other directions: a fit makes them so rough that all glint a little everywhere.
TEST(GrooveAgreement, OtherDirectionsAtTheSamePlacesAreOtherGrooves) {
  SmallGrooves own, other;
  fill_small_grooves(own, 11);
  std::mt19937_64 random = fill_small_grooves(other, 11);
  std::uniform_real_distribution<double> turn(0, std::numbers::pi);
  std::normal_distribution<float> normal;
  Scratches& turned = other.sent.scratches;
  for (std::size_t i = 0; i < turned.size(); ++i) {
    const double x = 0.5 * (turned.x0_mm[i] + turned.x1_mm[i]), y = 0.5 * (turned.y0_mm[i] + turned.y1_mm[i]);
    const double a = turn(random);
    turned.x0_mm[i] = x - 2 * std::cos(a), turned.x1_mm[i] = x + 2 * std::cos(a);
    turned.y0_mm[i] = y - 2 * std::sin(a), turned.y1_mm[i] = y + 2 * std::sin(a);
  }
  for (const SmallGrooves* carved : {&own, &other}) {
    SmallGrooves s;
    fill_small_grooves(s, 11);
    State state = s.truth;
    if (carved == &other) state.shared[unknown::log_alpha] = std::log(0.4);
    for (int k = 0; k < 6; ++k) {
      LightView view = add_view(s, k);
      PhotoData photo = make_photo_data(view, 1, s.board, s.bench, 2);
      photo.photo.value =
          predict(carved->data.model, photo, s.truth.of(0), carved_at(carved->data.model, s.truth.of(0)));
      const float noise = 0.01F * *std::max_element(photo.photo.value.data.begin(), photo.photo.value.data.end());
      for (std::size_t i = 0; i < photo.weight.size(); ++i) {
        photo.photo.value.data[i] += noise * normal(random);
        photo.photo.sigma.data[i] = noise;
        if (photo.weight[i] > 0) photo.weight[i] = 1 / noise;
      }
      s.data.photos.push_back(std::move(photo));
    }
    s.data.photo_model_error.assign(s.data.photos.size(), 0.1);
    const std::vector<GrooveAgreement> agreements = groove_agreements(s.data, state);
    for (const GrooveAgreement& one : agreements)
      EXPECT_TRUE(carved == &own ? one.share > 0.9 : one.share < 0.25) << one.share << " at " << one.sigmas;
    EXPECT_EQ(photos_of_other_grooves(agreements).size(), carved == &own ? 0 : agreements.size());
  }
}

TEST(GrooveAgreement, SingleGroovesTellABoardOfTheSamePictures) {
  SmallGrooves own, other;
  fill_small_grooves(own, 11);
  std::mt19937_64 random = fill_small_grooves(other, 11);
  std::normal_distribution<double> normal;
  Scratches& moved = other.sent.scratches;
  for (std::size_t i = 0; i < moved.size(); ++i) {
    const double x_mm = 1.2 * normal(random), y_mm = 1.2 * normal(random);
    moved.x0_mm[i] += x_mm, moved.x1_mm[i] += x_mm;
    moved.y0_mm[i] += y_mm, moved.y1_mm[i] += y_mm;
  }
  for (SmallGrooves* carved : {&own, &other})
    for (const double noise : {0.02, 30.0}) {
      SmallGrooves s;
      fill_small_grooves(s, 11);
      std::vector<LightView> views;
      for (int k = 0; k < 6; ++k) {
        LightView& view = views.emplace_back(add_view(s, k));
        view.value = predict(carved->data.model, make_photo_data(view, 1, s.board, s.bench, 2), s.truth.of(0),
                             carved_at(carved->data.model, s.truth.of(0)));
        float brightest = 0;
        for (const float value : view.value.data) brightest = std::max(brightest, value);
        for (std::size_t i = 0; i < view.value.data.size(); ++i) {
          view.sigma.data[i] = static_cast<float>(noise * brightest);
          view.value.data[i] += static_cast<float>(noise * brightest * normal(random));
        }
      }
      const SingleGrooves seen = compare_single_grooves(s.data, views, s.bench, s.truth);
      if (noise > 1) {
        EXPECT_FALSE(shows_other_grooves(seen) || shows_these_grooves(seen)) << seen.share << " +- " << seen.sigma;
        continue;
      }
      EXPECT_NEAR(seen.share, carved == &own ? 1 : 0, carved == &own ? 0.1 : 0.4) << seen.sigma;
      EXPECT_EQ(shows_these_grooves(seen), carved == &own) << seen.share << " +- " << seen.sigma;
      EXPECT_EQ(shows_other_grooves(seen), carved == &other) << seen.share << " +- " << seen.sigma;
    }
}

}  // namespace
}  // namespace burin
