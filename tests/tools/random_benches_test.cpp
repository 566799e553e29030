// `scripts/random-benches` as a person meets it: what it draws is a truth that `burin simulate` can photograph, the
// same for the same seed; a bench that measured exactly the truth is told to have no error, and one that is off by five
// of its sigmas is named; benches with departures can be photographed, and errors that nothing announces are named. Not
// proved: that Burin's sigmas hold, which takes the forty benches themselves.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "tests/places.h"
#include "tests/tools/program.h"

namespace burin {
namespace {

using ::testing::HasSubstr;

std::string tool(const TemporaryFolder& folder, const std::string& arguments) {
  return "cd " + quoted(folder.path().string()) + " && " + quoted(places::source() + "/scripts/random-benches") +
         " --burin " + quoted(places::program()) + " " + arguments;
}

TEST(RandomBenches, SameSeedSameTruthAndItCanBePhotographed) {
  const TemporaryFolder folder;
  ASSERT_EQ(run_shell(folder, tool(folder, "--seed 3 --count 2 --out a --draw-only")).exit_code, 0);
  ASSERT_EQ(run_shell(folder, tool(folder, "--seed 3 --count 1 --first 1 --out b --draw-only")).exit_code, 0);
  const std::string drawn = file_text(folder / "a/bench-3-001/truth.json");
  EXPECT_EQ(drawn, file_text(folder / "b/bench-3-001/truth.json"));
  EXPECT_NE(drawn, file_text(folder / "a/bench-3-000/truth.json"));
  const Outcome photo = run_burin(
      folder, {"simulate", "a/bench-3-001/truth.json", "--out", "a/bench-3-001", "--samples", "1", "--views", "v00"});
  EXPECT_EQ(photo.exit_code, 0) << photo.err;
}

TEST(RandomBenches, TellsErrorsInSigmas) {
  const TemporaryFolder folder;
  folder.write("bench-3-000/result.json",
               R"({"number": 0, "seconds": {"refine": 1}, "failed": null, "rows": [["alpha", "alpha", 0.001, 0.001],
                   ["depth", "depth_um", -0.5, 0.1], ["lamp", "lamp.x_mm", 0.1, 1], ["lamp", "lamp.y_mm", 0, 1]]})");
  const Outcome run = run_shell(folder, tool(folder, "--seed 3 --count 1 --out ."));
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.out, HasSubstr("bench 0 is beyond 4 sigma: depth_um -5.0"));
  EXPECT_THAT(run.out, HasSubstr("4 parameters: 75.0 % within 2 sigma"));
}

TEST(RandomBenches, DeparturesCanBePhotographedAndUnannouncedErrorsAreNamed) {
  const TemporaryFolder folder;
  const std::string many = "--departures disk,sky-panel,curve,mosaic,glare,satin-tags,flanks,brushed,backlash,screws";
  ASSERT_EQ(run_shell(folder, tool(folder, "--seed 3 --count 1 --out a --draw-only --together " + many)).exit_code, 0);
  const Outcome photo = run_burin(
      folder, {"simulate", "a/bench-3-000/truth.json", "--out", "a/bench-3-000", "--samples", "1", "--views", "v00"});
  EXPECT_EQ(photo.exit_code, 0) << photo.err;
  const Outcome unknown = run_shell(folder, tool(folder, "--seed 3 --out b --draw-only --departures disk,moon"));
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_THAT(unknown.err, HasSubstr("moon is not known"));
  for (const std::string said : {"true", "false"}) {
    folder.write("bench-3-000/result.json",
                 R"({"number": 0, "seconds": {"refine": 1}, "failed": null, "departures": ["disk"], "misfits": [],
                     "percent": {"alpha": [3.1, 1.0, )" +
                     said + R"(]}, "rows": [["alpha", "alpha", 0.001, 0.001]]})");
    const Outcome run = run_shell(folder, tool(folder, "--seed 3 --count 1 --departures disk --out ."));
    EXPECT_EQ(run.exit_code, said == "true" ? 0 : 1);
    EXPECT_THAT(run.out, HasSubstr(said == "true" ? "nothing announces: none" : "nothing announces: alpha of bench 0"));
  }
}

}  // namespace
}  // namespace burin
