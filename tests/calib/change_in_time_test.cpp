// Proves: odd photos that one moment parts from the others are one change; others are none. Of grooves: one photo of
// another board is named, many are all the photos' fault, and a fit that has not got far blames none.
#include "burin/calib/change_in_time.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "burin/calib/verdict/groove_agreement.h"

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

TEST(GrooveAgreement, OnePhotoOfAnotherBoardIsNamedAndManyAreNotAFit) {
  const GrooveAgreement own{true, 0.9}, other{true, 0.02}, dark{false, 0}, vague{true, 0.35};
  EXPECT_TRUE(photos_of_other_grooves({own, own, own, dark}).empty());
  EXPECT_EQ(photos_of_other_grooves({own, own, other, own, dark}), std::vector<std::size_t>{2});
  EXPECT_EQ(photos_of_other_grooves({other, other, dark, other}), (std::vector<std::size_t>{0, 1, 3}));
  EXPECT_TRUE(photos_of_other_grooves({vague, vague, vague, other}).empty());
  EXPECT_TRUE(photos_of_other_grooves({other, other}).empty()) << "two photos are too few";
}

}  // namespace
}  // namespace burin
