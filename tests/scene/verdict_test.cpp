// Proves: every cause has words and comes back from a file as it was; what a verdict says to people follows from its
// facts; names of parameters are told in words and stay apart. Not proved: how verdicts are reached (tests/calib).
#include "burin/scene/verdict.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "burin/scene/files/verdict_json.h"
#include "burin/scene/parameter_name.h"

namespace burin {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

TEST(Verdict, EveryCauseHasAFormAndWords) {
  for (int kind = 0; kind <= static_cast<int>(Cause::Kind::told); ++kind) {
    Verdict verdict{Source::measured, Degree::weakly, 0.25, Unit::mm, {}};
    const Verdict plain = verdict;
    verdict.causes = {{static_cast<Cause::Kind>(kind), {}, ""}};
    if (verdict.causes[0].kind == Cause::Kind::told) verdict.causes[0].text = "as it was told";
    const Json json = verdict_json(verdict);
    const Verdict back = read_verdict(JsonObject(json, "verdict"));
    ASSERT_EQ(back.causes.size(), 1u);
    EXPECT_EQ(back.causes[0].kind, verdict.causes[0].kind) << kind;
    EXPECT_NE(sentence(verdict), sentence(plain)) << kind << " has no words";
    EXPECT_EQ(json["reason"], sentence(verdict));
  }
}

TEST(Verdict, SaysWhatItsFactsSay) {
  Verdict alpha{Source::measured, Degree::determined, 0.412, Unit::percent, {}};
  alpha.causes = {{Cause::Kind::halves_of_photos, {0.8, 2.4, 6, 1.5}}};
  EXPECT_EQ(sentence(alpha),
            "one sigma is 0.41 %; halves of the photos agree (their difference is 0.8 of what is to be expected; up to "
            "2.4 is chance)");
  alpha.degree = Degree::not_determined;
  alpha.causes = {{Cause::Kind::halves_of_photos, {8, 2.4, 6, 5}}};
  EXPECT_THAT(sentence(alpha), HasSubstr("0.41 %, so the photos do not determine it; halves of the photos contradict"));
  EXPECT_THAT(sentence(alpha), HasSubstr("it rests on few of the photos"));
  EXPECT_EQ(sentence(given_verdict()), "given, and held fixed");
  Verdict depth;
  depth.causes = {{Cause::Kind::cutoff_not_seen, {0, 1234567}}};
  EXPECT_EQ(sentence(depth),
            "0 half vectors lean a little less and 1234567 a little more than the grooves' steepest wall, so no photo "
            "shows where the glints end; photograph the board from nearer to the lamp's mirror image");
  // No photo makes smaller what the tags' places add: that is named where it is most of a sigma.
  Verdict map{Source::measured, Degree::weakly, 0.21, Unit::mm, {}};
  map.causes = {{Cause::Kind::of_carve_area, {0.008}}};
  EXPECT_THAT(sentence(map),
              AllOf(HasSubstr("0.008 mm without"), HasSubstr("with a ruler"), HasSubstr("tags.sigma_mm")));
  map.causes = {{Cause::Kind::of_carve_area, {0.19}}};
  EXPECT_THAT(sentence(map), Not(HasSubstr("ruler")));
  NextPhoto next{NextPhoto::Kind::at_place, "camera 620 mm above the board's middle", 4.25, {}};
  EXPECT_EQ(sentence(next, Unit::mm), "camera 620 mm above the board's middle; its sigma would come to about 4.2 mm");
}

TEST(ParameterName, IsToldInWords) {
  EXPECT_EQ(parameter::in_words(parameter::kDepth), "the depth d");
  EXPECT_EQ(parameter::light_position("a.b"), "light.a.b.position_mm");
  EXPECT_EQ(parameter::in_words(parameter::light_falloff("a.b")), "the fall-off exponent of lamp “a.b”");
  EXPECT_EQ(parameter::in_words(parameter::pose("v03")), "the camera's place in view v03");
  EXPECT_EQ(parameter::in_words("something else"), "something else");
}

}  // namespace
}  // namespace burin
