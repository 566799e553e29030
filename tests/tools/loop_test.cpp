// The whole loop on a tiny copy of the sample: it stops for a person where there is no workshop, goes on where it
// stopped, ends with a second design, and measures the bench from the photos alone (truth.json is taken away before).
// How right each step is, is proved in its own room; here the oracle is the truth that the simulated camera used.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "burin/scene/scratches.h"
#include "tests/places.h"
#include "tests/tools/loop_bench.h"
#include "tests/tools/program.h"

namespace burin {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using ::testing::HasSubstr;
using ::testing::Not;

Json read(const fs::path& file) { return read_json_file(file); }

// Photos of 600 x 467 pixels.
void make_project(const TemporaryFolder& folder) {
  make_tiny_project(folder, {"d0", "d1", "c0", "c2", "c3", "c5"}, 2.0 / 3);
}

TEST(Loop, StopsForAPersonGoesOnAndMeasuresFromThePhotosAlone) {
  const TemporaryFolder folder;
  make_project(folder);
  const fs::path project = folder / "project", round = project / "round-01";

  // No workshop, no photos: it designs, writes what to carve, and says what to do.
  const Outcome first = run_burin(folder, {"loop", "project"});
  ASSERT_EQ(first.exit_code, 0) << first.err;
  EXPECT_THAT(first.out, HasSubstr("Put the photos into"));
  EXPECT_TRUE(fs::exists(round / "board.gcode"));
  EXPECT_FALSE(fs::exists(round / "session.json"));

  // The same again: nothing to do until there are photos.
  const std::string scratches = file_text(round / "scratches.csv");
  const Outcome idle = run_burin(folder, {"loop", "project"});
  ASSERT_EQ(idle.exit_code, 0) << idle.err;
  EXPECT_THAT(idle.out, Not(HasSubstr("burin design")));
  EXPECT_EQ(file_text(round / "scratches.csv"), scratches);

  // Scratches with a width, a depth and a roughness of their own: the machine is sent these too, in its own order. The
  // bench is the nominal one here, so that nothing is compensated.
  std::filesystem::copy_file(round / "scratches.csv", folder / "designed.csv");
  std::ofstream(round / "scratches.csv")
      << "x0_mm,y0_mm,x1_mm,y1_mm,width_um,depth_um,alpha\n30,30,34,33,400,11,0.04\n80,70,82,74,400,9,0.05\n"
         "60,31,64,34,400,10,0.06\n";
  EXPECT_EQ(run_burin(folder, {"loop", "project"}).exit_code, 1) << "changed by hand: it asks";
  ASSERT_EQ(run_burin(folder, {"loop", "project", "--allow-stale"}).exit_code, 0);
  const Scratches sent = read_scratches(round / "sent.csv");
  ASSERT_EQ(sent.size(), 3U);
  ASSERT_EQ(sent.alpha.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    const double x = std::min(sent.x0_mm[i], sent.x1_mm[i]);
    EXPECT_NEAR(sent.width_um[i], 400, 1e-6);
    EXPECT_NEAR(sent.depth_um[i], x < 40 ? 11 : x < 70 ? 10 : 9, 0.06) << "G-code has four decimals of a mm";
    EXPECT_NEAR(sent.alpha[i], x < 40 ? 0.04 : x < 70 ? 0.06 : 0.05, 1e-9);
  }
  fs::copy_file(folder / "designed.csv", round / "scratches.csv", fs::copy_options::overwrite_existing);

  // The workshop carves what the machine was sent, and the loop goes on from there.
  fs::copy_file(folder / "truth.json", project / "truth.json");
  const Outcome turned = run_burin(folder, {"loop", "project", "--allow-undetermined", "depth_um"});
  ASSERT_EQ(turned.exit_code, 0) << turned.out << turned.err;
  EXPECT_THAT(turned.out, HasSubstr("== round-01: photos (carve and photograph"));
  EXPECT_THAT(turned.out, HasSubstr("The loop has turned 1 time"));
  EXPECT_TRUE(fs::exists(project / "round-02" / "board.gcode"));
  // So few strokes fill fewer pixels than usual; what the second board gains is seen in the same ones.
  const auto pixels = [&](const char* of) { return read(project / of / "design" / "design-report.json")["pixels"]; };
  EXPECT_LT(pixels("round-01")[0], 512);
  EXPECT_THAT(turned.out, HasSubstr(" --pixels " + std::to_string(pixels("round-01")[0].get<int>())));
  EXPECT_EQ(pixels("round-02"), pixels("round-01"));
  const std::string page = file_text(project / "report.html");
  EXPECT_THAT(page, HasSubstr("Round 1, photographed"));
  EXPECT_THAT(page, Not(HasSubstr("src=\"http")));
  EXPECT_THAT(page, Not(HasSubstr("href=")));

  // Without the truth, and with its records alone: the same photos give the same bench, to the bit.
  const std::string bench = file_text(round / "bench.json");
  fs::remove(project / "truth.json");
  const Outcome again = run_burin(folder, {"loop", "project", "--force", "round-01/refine"});
  ASSERT_EQ(again.exit_code, 0) << again.out << again.err;
  EXPECT_THAT(again.out, HasSubstr("Going on with: round-01: refine"));
  EXPECT_EQ(file_text(round / "bench.json"), bench);

  // It is the true bench that was found, not the believed one (alpha 0.04, depth 11 um, lamp 13 mm away).
  const Json measured = Json::parse(bench), truth = read(folder / "truth.json");
  const Json &found = measured["material"], &real = truth["material"];
  EXPECT_NEAR(found["alpha"].get<double>(), real["alpha"].get<double>(), 0.06 * real["alpha"].get<double>());
  // So few scratches may leave the depth open; a depth that is told must be right.
  if (measured["verdict"]["depth_um"]["degree"] == "determined") {
    EXPECT_NEAR(found["depth_um"].get<double>(), real["depth_um"].get<double>(), 0.10 * real["depth_um"].get<double>());
  }
  // The lamp must be nearer than was believed, and no further off than it says.
  const Json& lamp = measured["lights"][0];
  double squares = 0;
  for (int i = 0; i < 3; ++i) {
    const double error = lamp["position_mm"][i].get<double>() - truth["lights"][0]["position_mm"][i].get<double>();
    EXPECT_LT(std::abs(error), 2 * lamp["position_sigma_mm"][i].get<double>() + 0.5) << "mm, axis " << i;
    squares += error * error;
  }
  EXPECT_LT(std::sqrt(squares), 5) << "mm, for a lamp half a meter away";
}

TEST(Loop, ProjectWithoutAFileIsRefusedBeforeAnyWork) {
  const TemporaryFolder folder;
  make_project(folder);
  fs::remove(folder / "project" / "bench.json");
  const Outcome run = run_burin(folder, {"loop", "project"});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.err, HasSubstr("project/bench.json"));
  EXPECT_FALSE(fs::exists(folder / "project" / "round-01"));
}

}  // namespace
}  // namespace burin
