// The progress line says how far the work is and guesses the time left from the time so far. That nothing is drawn
// without a terminal is proved by every program test, whose stderr is a file.
#include "tools/progress_bar.h"

#include <gtest/gtest.h>

#include <cmath>

namespace burin {
namespace {

TEST(ProgressLine, GuessesTheTimeLeftFromTheTimeSoFar) {
  EXPECT_EQ(progress_line("finding tags", 0.25, 30), "[#####---------------]  25 %  finding tags, 1:30 left");
  EXPECT_EQ(progress_line("finding tags", 1, 30), "[####################] 100 %  finding tags, 0:00 left");
}

TEST(ProgressLine, DoesNotGuessFromTooLittle) {
  EXPECT_EQ(progress_line("solving", 0.01, 3), "[--------------------]   1 %  solving");
}

TEST(ProgressLine, SurvivesFractionsThatAreNone) {
  EXPECT_EQ(progress_line("solving", std::nan(""), 3), "[--------------------]   0 %  solving");
  EXPECT_EQ(progress_line("solving", 7, 3), "[####################] 100 %  solving, 0:00 left");
  EXPECT_EQ(progress_line("solving", -1, 3), "[--------------------]   0 %  solving");
}

}  // namespace
}  // namespace burin
