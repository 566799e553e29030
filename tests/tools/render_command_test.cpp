// Proves: `burin render` shows what it is asked for: views, lamps, scratches and exposure make the difference that they
// should, linear files stay linear, and what is not there is named.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>

#include "burin/render/image.h"
#include "tests/places.h"
#include "tests/tools/program.h"

namespace burin {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;

class RenderCommand : public ::testing::Test {
 protected:
  void SetUp() override {
    fs::copy(fs::path(places::source()) / "samples" / "small-bench", folder_ / "bench", fs::copy_options::recursive);
    // Scratches in all directions, so that some glint from anywhere.
    std::string rows = "x0_mm,y0_mm,x1_mm,y1_mm\n";
    for (int i = 0; i < 180; ++i) {
      const double a = i * std::numbers::pi / 180, x = 25 + 70.0 * (i % 12) / 11, y = 25 + 70.0 * (i / 12) / 14;
      rows += std::to_string(x) + "," + std::to_string(y) + "," + std::to_string(x + 4 * std::cos(a)) + "," +
              std::to_string(y + 4 * std::sin(a)) + "\n";
    }
    folder_.write("all.csv", rows);
    folder_.write("one.csv", "x0_mm,y0_mm,x1_mm,y1_mm\n50,50,54,51\n");
  }
  Outcome render(const std::string& out, const std::vector<std::string>& more) const {
    std::vector<std::string> line{"render", "bench/board.json", "--bench", "bench/bench.json", "--out", out};
    line.insert(line.end(), more.begin(), more.end());
    return run_burin(folder_, line);
  }
  Image picture(const std::string& out, const std::vector<std::string>& more) const {
    const Outcome run = render(out, more);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return read_picture(folder_ / out);
  }
  static double sum(const Image& image) {
    double total = 0;
    for (const float v : image.data) total += v;
    return total;
  }

  TemporaryFolder folder_;
};

TEST_F(RenderCommand, LinearFilesHoldTheRadianceTimesTheExposure) {
  const Image one = picture("one.exr", {"--view", "d0", "--scratches", "all.csv"});
  const Image three = picture("three.exr", {"--view", "d0", "--scratches", "all.csv", "--exposure", "3"});
  ASSERT_GT(sum(one), 0);
  ASSERT_EQ(one.data.size(), three.data.size());
  for (std::size_t i = 0; i < one.data.size(); i += 97)
    EXPECT_NEAR(three.data[i], 3 * one.data[i], 0.004F * three.data[i] + 1e-6F);  // EXR may keep halves
}

TEST_F(RenderCommand, PicturesForTheScreenAreAsBrightAsTheyMayBe) {
  const Image image = picture("d0.png", {"--view", "d0", "--scratches", "all.csv"});
  EXPECT_EQ(*std::max_element(image.data.begin(), image.data.end()), 1.0F);
  EXPECT_EQ(*std::min_element(image.data.begin(), image.data.end()), 0.0F);
}

TEST_F(RenderCommand, MoreScratchesGiveMoreLightAndViewsDiffer) {
  const Image few = picture("few.exr", {"--view", "d0", "--scratches", "one.csv"});
  const Image many = picture("many.exr", {"--view", "d0", "--scratches", "all.csv"});
  const Image other = picture("other.exr", {"--view", "d1", "--scratches", "all.csv"});
  EXPECT_GT(sum(many), sum(few));
  EXPECT_NE(many.data, other.data);
}

TEST_F(RenderCommand, AsCarvedGoesThroughTheMachine) {
  auto bench = nlohmann::ordered_json::parse(file_text(folder_ / "bench" / "bench.json"));
  bench["machine"]["affine"] = {{1, 0, 5}, {0, 1, 0}};
  std::ofstream(folder_ / "bench" / "bench.json") << bench;
  folder_.write("moved.csv", "x0_mm,y0_mm,x1_mm,y1_mm\n55,50,59,51\n");
  const Image carved = picture("a.exr", {"--view", "d0", "--scratches", "one.csv", "--as-carved"});
  EXPECT_EQ(carved.data, picture("b.exr", {"--view", "d0", "--scratches", "moved.csv"}).data);
  EXPECT_NE(carved.data, picture("c.exr", {"--view", "d0", "--scratches", "one.csv"}).data);
}

TEST_F(RenderCommand, WhatIsNotThereIsNamed) {
  const auto expect = [&](const std::vector<std::string>& more, const std::string& about, const std::string& what) {
    const Outcome run = render("out.exr", more);
    EXPECT_EQ(run.exit_code, 1);
    EXPECT_THAT(run.err, AllOf(HasSubstr(about), HasSubstr(what)));
    EXPECT_FALSE(fs::exists(folder_ / "out.exr"));
  };
  expect({"--view", "d7", "--scratches", "all.csv"}, "d7", "d0");
  expect({"--view", "d0", "--light", "sun", "--scratches", "all.csv"}, "sun", "lamp");
  expect({"--view", "d0", "--scratches", "none.csv"}, "none.csv", "");
  expect({"--view", "d0"}, "bench/scratches.csv", "does not exist");  // the board's own, not made yet
  EXPECT_EQ(render("out.xyz", {"--view", "d0", "--scratches", "all.csv"}).exit_code, 1);
  EXPECT_EQ(render("out.exr", {}).exit_code, 2);
}

}  // namespace
}  // namespace burin
