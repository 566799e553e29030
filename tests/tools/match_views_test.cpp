// Proves: a designed view is found again among the measured ones by its place, in all three directions; where none or
// several are near, it is asked and not guessed, with distances that are right; lamps as well, whatever their names;
// the renamed bench is the measured one under the designed names. Oracle: places that the test itself set out, and the
// case of a real journey, in which the photo of a plan was taken for the eye of a design.
#include "tools/match_views.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

#include "burin/base/error.h"
#include "burin/scene/far_light.h"
#include "burin/scene/parameter_name.h"
#include "tests/temporary_folder.h"
#include "tools/project.h"
#include "tools/round_names.h"

namespace burin {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;
using ::testing::ThrowsMessage;

constexpr double kDegree = std::numbers::pi / 180;

// An eye `distance_mm` from the middle of a 300 x 200 mm board, turned from its normal: to the right, and up.
View eye(const std::string& name, double distance_mm, double right_deg, double up_deg) {
  const Eigen::Vector3d away(std::sin(right_deg * kDegree) * std::cos(up_deg * kDegree), std::sin(up_deg * kDegree),
                             std::cos(right_deg * kDegree) * std::cos(up_deg * kDegree));
  const Eigen::Vector3d center = Eigen::Vector3d(150, 100, 0) + distance_mm * away;
  const Eigen::Vector3d right = Eigen::Vector3d::UnitY().cross(away).normalized();
  View view;
  view.name = name;
  Eigen::Matrix3d R;  // rows: right, down, towards the board
  R << right.transpose(), -away.cross(right).transpose(), -away.transpose();
  view.T_camera_board.linear() = R;
  view.T_camera_board.translation() = -R * center;
  return view;
}

Light lamp(const std::string& id, const Eigen::Vector3d& place_mm) {
  Light light;
  light.id = id;
  light.position_mm = place_mm;
  return light;
}

class MatchViews : public ::testing::Test {
 protected:
  MatchViews() {
    board_.size_mm = board_.carve_max_mm = {300, 200};
    designed_.views = {eye("left", 1200, -30, 0), eye("middle", 1200, 0, 0), eye("right", 1200, 30, 0)};
    designed_.lights = {lamp("ceiling", {150, 900, 900})};
    for (const char* view : {"left", "middle", "right"}) {
      DesignView picture;
      picture.view = view;
      picture.light = "ceiling";
      design_.views.push_back(picture);
    }
    // As capture names them, and a camera in another order.
    measured_.views = {eye("v00", 1195, 30.4, 0.2), eye("v01", 1208, 0.542, 0), eye("v02", 1210, -29.6, 0.3),
                       eye("v03", 700, 15, 20)};
    measured_.lights = {lamp("lamp", {158, 908, 893})};
  }

  Matching match(const GivenNames& given = {}) const {
    return match_bench(design_, designed_, measured_, board_, match_tolerances(design_, designed_, board_, {}), given);
  }
  // What a person reads where something is undecided.
  std::string question(const GivenNames& given = {}) const {
    try {
      require_complete(match(given), "round-01/bench.json");
    } catch (const Error& asked) {
      return asked.what();
    }
    return "";
  }

  Board board_;
  Bench designed_, measured_;
  DesignSpec design_;
};

TEST_F(MatchViews, LampsThatShineAtOnceAreFoundOneByOne) {
  designed_.lights = {lamp("red", {150, 900, 900}), lamp("green", {-600, 700, 700}), lamp("blue", {900, 700, 700})};
  measured_.lights = {lamp("l1", {904, 698, 702}), lamp("l2", {152, 905, 893}), lamp("l3", {-603, 702, 699})};
  for (DesignView& picture : design_.views) {
    picture.light = "red + green + blue";
    picture.color = true;
  }
  const Matching m = match();
  ASSERT_TRUE(m.complete());
  ASSERT_THAT(m.lamps, SizeIs(3));
  EXPECT_EQ(m.lamps[0].measured, "l2");
  EXPECT_EQ(m.lamps[1].measured, "l3");
  EXPECT_EQ(m.lamps[2].measured, "l1");
  EXPECT_EQ(find_light(m.bench, "red + green + blue", "test").also.size(), 2U);
}

TEST_F(MatchViews, FindsEachEyeAndTheLampWhateverTheyAreCalled) {
  const Matching m = match();
  ASSERT_TRUE(m.complete());
  EXPECT_EQ(m.views[0].measured, "v02");
  EXPECT_EQ(m.views[1].measured, "v01");
  EXPECT_EQ(m.views[2].measured, "v00");
  EXPECT_EQ(m.lamps[0].measured, "lamp");
  const Offset& middle = m.views[1].near.front().offset;
  EXPECT_NEAR(middle.sideways_mm, 1200 * std::tan(0.542 * kDegree), 1e-6);
  EXPECT_NEAR(middle.up_mm, 0, 1e-6);
  EXPECT_NEAR(middle.along_mm, 8, 1e-6);
  EXPECT_NEAR(middle.degrees, 0.542, 1e-6);
  EXPECT_NEAR(m.lamps[0].near.front().offset.mm, std::hypot(8, 8, 7), 1e-9);
  const std::vector<Finding> told = matched_findings(m, "round-01/bench.json");
  ASSERT_THAT(told, SizeIs(4));
  EXPECT_THAT(sentence(told[1]), AllOf(HasSubstr("view \"middle\" of the design is \"v01\", 11 mm to the right"),
                                       HasSubstr("8.0 mm further away"), HasSubstr("0.54 degrees")));
  for (const Finding& finding : told) EXPECT_EQ(finding.severity, Finding::Severity::note);
}

// The journey: the true photo at 1,208 mm, 0.542 degrees off; a plan's shot at 334 mm, 0.467 degrees off. The
// direction alone speaks for the wrong one.
TEST_F(MatchViews, APlannedShotOnTheWayToAnEyeIsNotThatEye) {
  measured_.views.push_back(eye("v04", 334, 0.467, 0));
  const Matching m = match();
  EXPECT_EQ(m.views[1].measured, "v01");
  ASSERT_THAT(m.views[1].near, SizeIs(1));
  EXPECT_THAT(m.views[1].other, SizeIs(4));
  // Without the true photo nothing is near, and the shot is not taken for it.
  measured_.views.erase(measured_.views.begin() + 1);
  EXPECT_FALSE(match().complete());
  EXPECT_THAT(
      question(),
      AllOf(HasSubstr("round-01/bench.json"), HasSubstr("\"middle\": no photo was taken near"),
            HasSubstr("the nearest is v04 (9.8 mm to the right, 866 mm nearer; 866 mm and 0.47 degrees in all)"),
            Not(HasSubstr("\"left\"")), HasSubstr("--view middle=v04")));
}

TEST_F(MatchViews, SeveralNearOneEyeAreAQuestionThatAnOptionAnswers) {
  measured_.views.push_back(eye("v04", 1190, -0.4, 0.6));
  EXPECT_FALSE(match().complete());
  EXPECT_TRUE(match().views[1].measured.empty());
  EXPECT_THAT(question(),
              AllOf(HasSubstr("view \"middle\": 2 places lie near it: v01 (11 mm to the right, 8.0 mm further "
                              "away"),
                    HasSubstr("v04 (8.4 mm to the left, 13 mm up, 10 mm nearer"), HasSubstr("--view middle=v01"),
                    HasSubstr("--view middle=v04")));
  GivenNames given;
  add_given_name("--view", "middle=v04", given.views);
  EXPECT_EQ(question(given), "");
  const Matching m = match(given);
  EXPECT_EQ(m.views[1].measured, "v04");
  EXPECT_TRUE(m.views[1].given);
  EXPECT_NEAR(find_view(m.bench, "middle", "test").T_camera_board.translation().norm(),
              find_view(measured_, "v04", "test").T_camera_board.translation().norm(), 1e-12);
}

// Two designed eyes so near each other that one photo could be either's.
TEST_F(MatchViews, OnePhotoIsNotTakenForTwoDesignedEyes) {
  designed_.views[1] = eye("middle", 1200, 0, 0);
  designed_.views[2] = eye("right", 1200, 1.5, 0);
  measured_.views = {eye("v00", 1200, 0.75, 0), eye("v01", 1200, -30, 0)};
  const Matching m = match();
  EXPECT_EQ(m.views[0].measured, "v01");
  EXPECT_TRUE(m.views[1].measured.empty());
  EXPECT_TRUE(m.views[2].measured.empty());
  EXPECT_THAT(question(), AllOf(HasSubstr("\"middle\": v00 lies near it"), HasSubstr("--view right=v00")));
}

TEST_F(MatchViews, ToleranceOfTheDesignDecidesWhatIsNear) {
  const TemporaryFolder folder;
  const auto report = [&](const std::string& mm) {
    const std::string range = "[-" + mm + ", " + mm + "]",
                      place = "{\"sideways\": " + range + ", \"up\": " + range + ", \"depth\": [-100, 120]}";
    return folder.write("design-report.json", R"({"format": "burin/design-report", "version": 1, "views": [
      {"view": "middle", "light": "ceiling", "tolerance": {"eye_mm": )" +
                                                  place + ", \"lamp_mm\": " + place + "}}]}");
  };
  const auto found = [&](const std::filesystem::path& file) {
    return match_bench(design_, designed_, measured_, board_, match_tolerances(design_, designed_, board_, file))
        .views[1]
        .measured;
  };
  // 11.35 mm aside: within three times 3.8 mm, but not three times 3.7 mm.
  EXPECT_EQ(found(report("3.9")), "v01");
  EXPECT_EQ(found(report("3.7")), "");
  EXPECT_EQ(found(folder / "none.json"), "v01");
  // People are told what was measured, however much it is: design, check, report and sheet say one number.
  const std::filesystem::path wide = report("345");
  EXPECT_EQ(shown_tolerances(design_, designed_, board_, wide)[1].eye.sideways.least(), 345);
  EXPECT_LT(match_tolerances(design_, designed_, board_, wide)[1].eye.sideways.least(), 345);
  EXPECT_THAT([&] { found(folder.write("design-report.json", "{")); },
              ThrowsMessage<Error>(HasSubstr("design-report.json")));
}

TEST_F(MatchViews, EstimatedToleranceGrowsWithRoughnessAndDistance) {
  const MatchTolerance plain = default_tolerance(design_.views[1], designed_, board_);
  // 0.35 * 0.766 * 0.04 * 1200 mm * |wi + wo|, the lamp 40.3 degrees from the eye.
  const double between = std::atan2(800, 900);
  EXPECT_NEAR(plain.eye.sideways.least(), 0.35 * 0.766 * 0.04 * 1200 * 2 * std::cos(between / 2), 1e-9);
  EXPECT_NEAR(plain.lamp.up.least() / plain.eye.up.least(), std::hypot(800, 900) / 1200, 1e-9);
  designed_.material.alpha = 0.08;
  EXPECT_NEAR(default_tolerance(design_.views[1], designed_, board_).eye.up.least(), 2 * plain.eye.up.least(), 1e-9);
}

TEST_F(MatchViews, TheOnlyLampMayBeFurtherOffAndThatIsTold) {
  measured_.lights[0].position_mm = {300, 900, 900};  // 150 mm of 1204
  const Matching m = match();
  EXPECT_EQ(m.lamps[0].measured, "lamp");
  const std::vector<Finding> told = matched_findings(m, "bench.json");
  EXPECT_EQ(told.back().severity, Finding::Severity::warning);
  EXPECT_THAT(sentence(told.back()),
              AllOf(HasSubstr("lamp \"ceiling\" of the design is \"lamp\""), HasSubstr("150 mm and 7.10 degrees")));
  measured_.lights[0].position_mm = {150, -900, 900};  // another corner of the room
  EXPECT_THAT(question(),
              AllOf(HasSubstr("lamp \"ceiling\": no lamp was found near its place"), HasSubstr("--lamp ceiling=lamp")));
}

TEST_F(MatchViews, OfTwoLampsEachIsFoundByItsPlace) {
  designed_.lights.push_back(lamp("window", {-700, 100, 900}));
  design_.views[0].light = "window";
  measured_.lights = {lamp("ceiling", {-690, 105, 905}), lamp("b", {150, 905, 898})};  // a name that says the opposite
  const Matching m = match();
  ASSERT_TRUE(m.complete());
  EXPECT_NEAR(find_light(m.bench, "window", "test").position_mm.x(), -690, 1e-12);
  EXPECT_NEAR(find_light(m.bench, "ceiling", "test").position_mm.y(), 905, 1e-12);
}

// Photos are taken under one lamp each, so each is measured on its own.
TEST_F(MatchViews, LampsThatShineAtOnceGetTheirNamesInAFile) {
  designed_.lights = {lamp("red", {150, 900, 900}), lamp("green", {-700, 100, 900}), lamp("blue", {900, 100, 300})};
  for (DesignView& picture : design_.views) picture.light = "red + green + blue";
  measured_.lights = {lamp("blue", {158, 905, 898}), lamp("b", {904, 103, 301}), lamp("c", {-694, 105, 905})};
  const Matching m = match();
  ASSERT_TRUE(m.complete()) << question();
  ASSERT_THAT(m.lamps, SizeIs(3));
  EXPECT_EQ(m.lamps[0].measured, "blue");
  EXPECT_EQ(m.lamps[1].measured, "c");
  EXPECT_EQ(m.lamps[2].measured, "b");
  const TemporaryFolder folder;  // the next round's design reads it from a file
  Bench named = m.bench;
  named.lens.model = "LENSMODEL_PINHOLE";
  named.lens.width = 900;
  named.lens.height = 700;
  named.lens.intrinsics = {2300, 2300, 450, 350};
  write_bench(named, board_.tool_width_um, folder / "bench-before.json");
  const Light all = find_light(read_bench(folder / "bench-before.json"), "red + green + blue", "test");
  EXPECT_NEAR(all.position_mm.y(), 905, 1e-6);
  ASSERT_THAT(all.also, SizeIs(2));
  EXPECT_NEAR(all.also[0].position_mm.x(), -694, 1e-6);
  EXPECT_NEAR(all.also[1].position_mm.x(), 904, 1e-6);
  // One that was taken away is asked for by its own name.
  measured_.lights.erase(measured_.lights.begin() + 2);
  EXPECT_THAT(question(), AllOf(HasSubstr("lamp \"green\": no lamp was found near its place"), Not(HasSubstr(" + "))));
}

TEST_F(MatchViews, EachOfSeveralLampsMayMoveByWhatItsOwnDistanceTolerates) {
  const Eigen::Vector2d middle = (board_.carve_min_mm + board_.carve_max_mm) / 2;
  const Eigen::Vector3d from(middle.x(), middle.y(), 0), way(50, 300, 300);
  designed_.lights = {lamp("near", from + way), lamp("far", from + 10 * way)};
  for (DesignView& picture : design_.views) picture.light = "near + far";
  const std::vector<DesignedLamp> lamps =
      designed_lamps(design_, designed_, board_, match_tolerances(design_, designed_, board_, {}));
  ASSERT_THAT(lamps, SizeIs(2));
  // Both in one direction from the board's middle, ten times the distance apart.
  EXPECT_NEAR(lamps[1].tolerance.sideways.least(), 10 * lamps[0].tolerance.sideways.least(), 1e-6);
  for (DesignView& picture : design_.views) picture.light = "near";
  const std::vector<DesignedLamp> alone =
      designed_lamps(design_, designed_, board_, match_tolerances(design_, designed_, board_, {}));
  EXPECT_NEAR(alone[0].tolerance.sideways.least(), lamps[0].tolerance.sideways.least(), 1e-9);
}

TEST_F(MatchViews, TheSunBesideALampStaysAsTheDesignHasIt) {
  designed_.lights.push_back(sun_light({0.2, 0.5, 0.8}, {3, 2, 1}));
  designed_.lights.back().id = "sun";
  for (DesignView& picture : design_.views) picture.light = "ceiling + sun";
  const Matching m = match();
  ASSERT_TRUE(m.complete()) << question();
  const Light all = find_light(m.bench, "ceiling + sun", "test");
  EXPECT_NEAR(all.position_mm.x(), 158, 1e-12);
  ASSERT_THAT(all.also, SizeIs(1));
  EXPECT_FALSE(all.also[0].is_near());
}

TEST_F(MatchViews, BenchTakesTheDesignedNamesWithAllThatIsKnownOfThem) {
  measured_.views[3].name = "left";  // a photo from elsewhere that is called like a designed view
  measured_.verdict[parameter::pose("v02")] = {Source::measured, Degree::determined, 0.1, Unit::mm};
  measured_.verdict[parameter::pose("left")] = {Source::measured, Degree::weakly, 7, Unit::mm};
  measured_.verdict[parameter::kPoses].causes = {{Cause::Kind::of_camera_distance, {}, "v02"}};
  measured_.verdict[parameter::light_position("lamp")] = {Source::measured, Degree::determined, 2, Unit::mm};
  const Matching m = match();
  ASSERT_TRUE(m.complete());
  std::vector<std::string> names;
  for (const View& view : m.bench.views) names.push_back(view.name);
  EXPECT_THAT(names, ::testing::UnorderedElementsAre("left", "middle", "right", "left-photo"));
  EXPECT_EQ(find_verdict(m.bench, parameter::pose("left"))->sigma, 0.1);
  EXPECT_EQ(find_verdict(m.bench, parameter::pose("left-photo"))->sigma, 7);
  EXPECT_EQ(find_verdict(m.bench, parameter::pose("v02")), nullptr);
  EXPECT_EQ(m.bench.verdict.at(parameter::kPoses).causes.front().text, "left");
  EXPECT_EQ(find_verdict(m.bench, parameter::light_position("ceiling"))->sigma, 2);
  EXPECT_EQ(find_verdict(m.bench, parameter::light_position("lamp")), nullptr);
}

TEST_F(MatchViews, GivenNamesThatDoNotExistAreRefused) {
  const auto given = [](const std::string& option, const std::string& text) {
    GivenNames names;
    add_given_name(option, text, option == "--view" ? names.views : names.lamps);
    return names;
  };
  EXPECT_THAT([&] { match(given("--view", "middle=v09")); }, ThrowsMessage<Error>(HasSubstr("v00, v01, v02, v03")));
  EXPECT_THAT([&] { match(given("--view", "top=v01")); }, ThrowsMessage<Error>(HasSubstr("left, middle, right")));
  EXPECT_THAT([&] { match(given("--lamp", "ceiling=sun")); }, ThrowsMessage<Error>(HasSubstr("choose one of: lamp")));
  for (const char* wrong : {"middle", "=v01", "middle="})
    EXPECT_THAT([&] { given("--view", wrong); }, ThrowsMessage<Error>(HasSubstr("--view middle=v01")));
}

TEST(RoundNames, ComeBackAsTheyWereWritten) {
  const TemporaryFolder folder;
  const GivenNames names{{{"middle", "v01"}}, {{"ceiling", "lamp"}}};
  write_names(names, folder / "names.json");
  const GivenNames read = read_names(folder / "names.json");
  EXPECT_EQ(read.views, names.views);
  EXPECT_EQ(read.lamps, names.lamps);
  EXPECT_THAT(read_names(folder / "none.json").views, IsEmpty());
  folder.write("names.json", R"({"format": "burin/names", "version": 1, "eyes": {}})");
  EXPECT_THAT([&] { read_names(folder / "names.json"); }, ThrowsMessage<Error>(HasSubstr("eyes")));
}

}  // namespace
}  // namespace burin
