// `scripts/bench-photos` as a person meets it: it photographs the sample, makes a session of it and enlarges the photos
// to as many megapixels as asked for, one a view; and says in a sentence what is wrong with a session that it cannot
// use. Not proved: how long calibrate and refine take, which needs an idle machine (docs/results/calibration.md has the
// figures).
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "tests/places.h"
#include "tests/tools/program.h"

namespace burin {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

Outcome bench_photos(const TemporaryFolder& folder, const std::string& arguments) {
  return run_shell(folder, "cd " + quoted(folder.path().string()) + " && " +
                               quoted(places::source() + "/scripts/bench-photos") + " --burin " +
                               quoted(places::program()) + " " + arguments);
}

TEST(BenchPhotos, PreparesTheSample) {
  const TemporaryFolder folder;
  const Outcome run = bench_photos(folder, "--prepare photos --views 2 --megapixels 0.2 --samples 1");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("2 photos of 507 x 394 pixels"));  // the sample's 9 : 7
  const auto session = nlohmann::json::parse(file_text(folder / "photos/session.json"));
  ASSERT_EQ(session["photos"].size(), 2U);
  for (const auto& photo : session["photos"])
    EXPECT_TRUE(std::filesystem::exists(folder / "photos" / photo["file"].get<std::string>()));
  EXPECT_NE(session["photos"][0]["view"], session["photos"][1]["view"]);
}

TEST(BenchPhotos, SaysWhatIsWrongWithASession) {
  const TemporaryFolder folder;
  folder.write("empty.json", R"({"format": "burin/session", "photos": []})");
  folder.write("cut.json", R"({"format": "burin/ses)");
  folder.write("gone.json",
               R"({"board": "board.json", "photos": [{"file": "gone.png", "view": "a", "exposure_s": 1}]})");
  for (const auto& [session, what] :
       {std::pair("missing.json", "no session can be read"), std::pair("empty.json", "it lists no photos"),
        std::pair("cut.json", "this is no JSON"), std::pair("gone.json", "gone.png")}) {
    const Outcome run = bench_photos(folder, "--session " + std::string(session));
    EXPECT_NE(run.exit_code, 0) << session;
    EXPECT_THAT(run.err, AllOf(HasSubstr("scripts/bench-photos: "), HasSubstr(what), Not(HasSubstr("Traceback"))));
  }
}

}  // namespace
}  // namespace burin
