// Proves: the sentence about a rerun says what the numbers say.
#include "tools/report/rerun.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

namespace burin {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

TEST(Rerun, SaysWhereItPaysAndWhyElsewhereNot) {
  const std::vector<RerunView> good{{"d0", 24, 16, 24.5, 24}, {"d1", 22, 17, 22, 21.1}};
  EXPECT_THAT(rerun_sentence(good), AllOf(HasSubstr("gains at least 4 dB in every view (d0 +8.0 dB, d1 +4.1 dB)"),
                                          Not(HasSubstr("gains less"))));
  // Nothing was lost to begin with.
  const std::vector<RerunView> little{{"d0", 24, 16, 24.5, 24}, {"d1", 22, 21, 22.5, 22.4}};
  EXPECT_THAT(rerun_sentence(little),
              AllOf(HasSubstr("does not gain 4 dB in every view"), HasSubstr("View d1 gains less"),
                    HasSubstr("cost it only 1.0 dB (promised 22.0, seen 21.0)")));
  // Much was lost, and the bench as it is does not give it back; or the measured bench is still wrong.
  const std::vector<RerunView> dark{{"d1", 24, 16, 18, {}}}, wrong{{"d1", 24, 16, 23, 19}};
  EXPECT_THAT(rerun_sentence(dark), HasSubstr("promises to regain 2.0"));
  EXPECT_THAT(rerun_sentence(wrong), HasSubstr("4.0 dB are still lost to what the measured bench does not know"));
}

}  // namespace
}  // namespace burin
