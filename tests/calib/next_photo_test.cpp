// Proves: a lamp is to be moved for a photo only where no photo under the lamps as they stand tells enough; and what is
// said of a moved lamp can be followed: the entry that it names is one that bench.json takes, under a name that is
// free. How good the advice is, is measured in refine_test.cpp and plan_test.cpp.
#include "burin/calib/verdict/next_photo.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace burin {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

TEST(NextPhoto, LampsStayWhereTheyAreIfThatTellsEnough) {
  EXPECT_TRUE(is_worth_taking(0.5, 0, 0));
  EXPECT_TRUE(is_worth_taking(0.66, 0, 0));
  EXPECT_FALSE(is_worth_taking(0.7, 0, 0)) << "less than a third less is not worth the way";
  EXPECT_FALSE(is_worth_taking(1, 0, 0)) << "no such photo was found";
  // A depth: 25 half vectors on either side show the cut-off; what two such photos show is enough.
  EXPECT_TRUE(is_worth_taking(1, 30, 0));
  EXPECT_TRUE(is_worth_taking(1, 16, 5));
  EXPECT_FALSE(is_worth_taking(1, 10, 4));
}

TEST(NextPhoto, MovedLampIsToldAsBenchJsonTakesIt) {
  Board board;
  board.size_mm = {120, 120};
  Light lamp;
  lamp.id = "ceiling";
  Light taken = lamp;
  taken.id = "ceiling-2";
  Light moved = lamp;
  moved.id = "ceiling-turned-90";
  moved.position_mm = {433.4, 60, 444.6};
  const std::string words = moved_lamp_in_words(moved, {lamp, taken}, board);
  EXPECT_THAT(words, AllOf(HasSubstr("the lamp moved to 445 mm above the face"), HasSubstr("\"lights\""),
                           HasSubstr("photos/ceiling-3")));
  const std::size_t begin = words.find('{'), end = words.find('}');
  ASSERT_LT(begin, end);
  const auto entry = nlohmann::json::parse(words.substr(begin, end - begin + 1));
  EXPECT_EQ(entry.at("id"), "ceiling-3");
  EXPECT_NEAR(entry.at("position_mm").at(0).get<double>(), 433.4, 0.51);
}

}  // namespace
}  // namespace burin
