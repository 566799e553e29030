// Proves what durations people may write, in what unit a bare number counts, and how durations are said.
#include "burin/optimize/duration.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <clocale>

#include "burin/base/error.h"

namespace burin {
namespace {

TEST(Duration, IsReadInUnitsThatMayFollowOneAnother) {
  EXPECT_EQ(duration_from_text("30min"), 1800);
  EXPECT_EQ(duration_from_text("5m"), 300);
  EXPECT_EQ(duration_from_text("45s"), 45);
  EXPECT_EQ(duration_from_text("1.5h"), 5400);
  EXPECT_EQ(duration_from_text("1h30min"), 5400);
  EXPECT_EQ(duration_from_text("1h30min15.5s"), 5415.5);
}

TEST(Duration, ABareNumberCountsInTheUnitAskedFor) {
  EXPECT_EQ(duration_from_text("90"), 90);
  EXPECT_EQ(duration_from_text("0.5"), 0.5);
  EXPECT_EQ(duration_from_text("5.5", 3600), 5.5 * 3600);
  EXPECT_EQ(duration_from_text("90min", 3600), 5400);  // a unit that is written is what it says
}

TEST(Duration, WhatIsNoneIsRefusedWithAnExample) {
  for (const char* wrong : {"", "min", "-5min", "5 years", "0s", "0", "nanmin", "nan", "inf", "1h30", "30min5", "h1",
                            "1e3", "+5s", "5min ", "1,5h"})
    EXPECT_THAT([&] { duration_from_text(wrong); }, testing::ThrowsMessage<Error>(testing::HasSubstr("1h30min")))
        << wrong;
}

TEST(Duration, TheLocaleDoesNotMatter) {
  const std::string before = std::setlocale(LC_ALL, nullptr);
  std::setlocale(LC_ALL, "de_DE.UTF-8");  // where it is not installed, this shows nothing
  EXPECT_EQ(duration_from_text("1.5h"), 5400);
  std::setlocale(LC_ALL, before.c_str());
}

TEST(Duration, IsSaidAsRoundlyAsOneNeedsIt) {
  EXPECT_EQ(duration_text(42.4), "42 s");
  EXPECT_EQ(duration_text(720), "12 min");
  EXPECT_EQ(duration_text(6.5 * 3600), "6 h 30 min");
}

}  // namespace
}  // namespace burin
