// burin plan, as a person runs it: a list to follow, plan.json and a drawing; and what it refuses. That its sigmas are
// right is plan_test's.
#include <gmock/gmock.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/places.h"
#include "tests/tools/program.h"

namespace burin {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

const std::string kSampleBench = places::source() + "/samples/small-bench/";

TEST(PlanCommand, SaysWhereToStandAndDrawsIt) {
  const TemporaryFolder folder;
  const Outcome run = run_burin(folder, {"plan", kSampleBench + "board.json", "--bench", kSampleBench + "bench.json",
                                         "--shots", "3", "--out", "plan"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, AllOf(HasSubstr("  3. camera "), HasSubstr("mm above the"), HasSubstr("Expected sigma"),
                             HasSubstr("depth_um"), HasSubstr("Wrote plan/plan.json")));
  const auto plan = nlohmann::json::parse(file_text(folder / "plan" / "plan.json"));
  EXPECT_EQ(plan["format"], "burin/plan");
  ASSERT_EQ(plan["shots"].size(), 3U);
  for (const auto& shot : plan["shots"]) {
    EXPECT_EQ(shot["sigma_after"].size(), plan["parameters"].size());
    EXPECT_GT(shot["center_mm"][2].get<double>(), 0);
    EXPECT_EQ(shot["light"]["id"], "lamp");
  }
  // Every camera and the lamp, in both views of the drawing.
  const std::string svg = file_text(folder / "plan" / "plan.svg");
  std::size_t cameras = 0, lamps = 0;
  for (std::size_t at = 0; (at = svg.find("<circle", at)) != std::string::npos; ++at) ++cameras;
  for (std::size_t at = 0; (at = svg.find(">lamp</text>", at)) != std::string::npos; ++at) ++lamps;
  EXPECT_EQ(cameras, 6U);
  EXPECT_EQ(lamps, 2U);
}

// A board is photographed from where it is to be looked at, and all of it with one focus.
TEST(PlanCommand, ViewsOfTheDesignComeFirstAndTheRestKeepsTheirFocus) {
  const TemporaryFolder folder;
  const Outcome run = run_burin(folder, {"plan", kSampleBench + "board.json", "--bench", kSampleBench + "bench.json",
                                         "--design", kSampleBench + "design.json", "--shots", "2", "--out", "plan"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, AllOf(HasSubstr("Focus once at 500 mm"), HasSubstr("  1. view \"d0\" of the design: camera"),
                             HasSubstr("--bench " + kSampleBench + "bench.json --out DIR")));
  const auto plan = nlohmann::json::parse(file_text(folder / "plan" / "plan.json"));
  ASSERT_EQ(plan["shots"].size(), 5U);
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(plan["shots"][i].contains("designed"), i < 3);
    EXPECT_GE(plan["shots"][i]["distance_mm"].get<double>(), plan["focus"]["near_mm"].get<double>() - 1e-6);
    EXPECT_LE(plan["shots"][i]["distance_mm"].get<double>(), plan["focus"]["far_mm"].get<double>() + 1e-6);
  }
  EXPECT_EQ(plan["shots"][2]["view"], "d2");
}

// What a person has at hand is a project: its design's views need no option.
TEST(PlanCommand, AProjectsFolderIsEnough) {
  const TemporaryFolder folder;
  const Outcome run =
      run_burin(folder, {"plan", kSampleBench, "--shots", "2", "--focus-range", "0.45-0.6m", "--out", "plan"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out,
              AllOf(HasSubstr("450 to 600 mm was said to be sharp"), HasSubstr("  3. view \"d2\" of the design"),
                    HasSubstr("If the grooves are not as deep as believed"), HasSubstr("burin loop ")));
  const auto plan = nlohmann::json::parse(file_text(folder / "plan" / "plan.json"));
  ASSERT_EQ(plan["shots"].size(), 5U);
  ASSERT_EQ(plan["at_depth"].size(), 3U);
  EXPECT_NEAR(plan["at_depth"][0]["depth_um"].get<double>(), 0.7 * plan["at_depth"][1]["depth_um"].get<double>(), 1e-9);
  for (const auto& shot : plan["shots"]) {
    EXPECT_GE(shot["distance_mm"].get<double>(), 449.9);
    EXPECT_LE(shot["distance_mm"].get<double>(), 600.1);
  }
  for (const char* wrong : {"500", "900-100", "1-2km"})
    EXPECT_EQ(run_burin(folder, {"plan", kSampleBench, std::string("--focus-range=") + wrong}).exit_code, 1) << wrong;
  EXPECT_EQ(run_burin(folder, {"plan", kSampleBench, "--focus-range", "450-600", "--focus", "700"}).exit_code, 1);
}

TEST(PlanCommand, LampsThatAreGivenReplaceTheBenchs) {
  const TemporaryFolder folder;
  const std::vector<std::string> plan = {
      "plan", kSampleBench + "board.json", "--bench", kSampleBench + "bench.json", "--shots", "2"};
  std::vector<std::string> arguments = plan;
  arguments.insert(arguments.end(), {"--lamp", "-200", "60", "500"});
  const Outcome run = run_burin(folder, arguments);
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("500 mm above the face, 200 mm beyond the left edge"));
  EXPECT_FALSE(std::filesystem::exists(folder / "plan"));

  arguments = plan;
  arguments.insert(arguments.end(), {"--lamp", "-200", "60", "-500"});
  const Outcome behind = run_burin(folder, arguments);
  EXPECT_EQ(behind.exit_code, 1);
  EXPECT_THAT(behind.err, HasSubstr("behind the board"));
}

TEST(PlanCommand, RefusesWrongNumbersAndMissingFiles) {
  const TemporaryFolder folder;
  EXPECT_EQ(run_burin(folder, {"plan", kSampleBench + "board.json", "--shots", "13"}).exit_code, 2);
  EXPECT_EQ(run_burin(folder, {"plan", "none.json"}).exit_code, 1);
}

}  // namespace
}  // namespace burin
