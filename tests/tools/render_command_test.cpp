// Proves: `burin render` shows what it is asked for: views, lamps, scratches and exposure make the difference that they
// should, linear files stay linear, and what is not there is named.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>

#include "burin/base/image.h"
#include "burin/pictures/picture.h"
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

TEST_F(RenderCommand, SeveralLampsShineAtOnce) {
  auto bench = nlohmann::ordered_json::parse(file_text(folder_ / "bench" / "bench.json"));
  auto other = bench["lights"][0];
  other["id"] = "other";
  other["position_mm"] = {200, 300, 500};
  bench["lights"].push_back(other);
  std::ofstream(folder_ / "bench" / "bench.json") << bench;
  const auto under = [&](const std::string& out, const std::vector<std::string>& lamps) {
    std::vector<std::string> words{"--view", "d0", "--scratches", "all.csv"};
    for (const std::string& lamp : lamps) words.insert(words.end(), {"--lamp", lamp});
    return picture(out, words);
  };
  const Image a = under("a.exr", {"lamp"}), b = under("b.exr", {"other"}), both = under("both.exr", {"lamp", "other"});
  ASSERT_GT(sum(a), 0);
  ASSERT_GT(sum(b), 0);
  EXPECT_NEAR(sum(both), sum(a) + sum(b), 1e-3 * sum(both));
}

TEST_F(RenderCommand, WhatIsNotThereIsNamed) {
  const auto expect = [&](const std::vector<std::string>& more, const std::string& about, const std::string& what) {
    const Outcome run = render("out.exr", more);
    EXPECT_EQ(run.exit_code, 1);
    EXPECT_THAT(run.err, AllOf(HasSubstr(about), HasSubstr(what)));
    EXPECT_FALSE(fs::exists(folder_ / "out.exr"));
  };
  expect({"--view", "d7", "--scratches", "all.csv"}, "d7", "d0");
  expect({"--view", "d0", "--lamp", "sun", "--scratches", "all.csv"}, "sun", "lamp");
  expect({"--view", "d0", "--scratches", "none.csv"}, "none.csv", "");
  expect({"--view", "d0"}, "bench/scratches.csv", "does not exist");  // the board's own, not made yet
  EXPECT_EQ(render("out.xyz", {"--view", "d0", "--scratches", "all.csv"}).exit_code, 1);
  EXPECT_EQ(render("out.exr", {}).exit_code, 2);
}

// A film's program of our own in the PATH: what is done with frames and leftovers, not what films look like.
class Film : public RenderCommand {
 protected:
  Outcome film(const std::string& program, const std::string& then) const {
    folder_.write("bin/ffmpeg", "#!/bin/sh\n" + program);
    fs::permissions(folder_ / "bin/ffmpeg", fs::perms(0700));
    return run_shell(folder_, "cd " + quoted(folder_.path().string()) + " && { PATH=$PWD/bin:$PATH " +
                                  quoted(places::program()) +
                                  " render bench/board.json --bench bench/bench.json --scratches all.csv --exposure 1 "
                                  "--frames 4 --pixels 32 --animate film.mp4" +
                                  then + "; }");
  }
  // Besides what the test has written, and where output goes.
  std::vector<std::string> made() const {
    std::vector<std::string> names;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder_.path()))
      if (const std::string name = entry.path().filename().string();
          name != "bench" && name != "bin" && name != "all.csv" && name != "one.csv" && name != "ffmpeg.process")
        names.push_back(name);
    return names;
  }
};

TEST_F(Film, IsMadeWithoutAFolderOfFrames) {
  const Outcome made_film = film("ls -A >seen; cat >&3\n", "");
  EXPECT_EQ(made_film.exit_code, 0) << made_film.err;
  EXPECT_EQ(file_text(folder_ / "seen").find("frames"), std::string::npos);
  fs::remove(folder_ / "seen");
  EXPECT_THAT(made(), ::testing::ElementsAre("film.mp4"));
  const std::string bytes = file_text(folder_ / "film.mp4");
  EXPECT_EQ(bytes.substr(1, 3), "PNG");
  std::size_t frames = 0;
  for (std::size_t at = 0; (at = bytes.find("IHDR", at)) != std::string::npos; ++at) ++frames;
  EXPECT_EQ(frames, 6U) << "there and back";
}

TEST_F(Film, ThatFailsLeavesNothing) {
  const Outcome failed = film("exit 1\n", "");
  EXPECT_EQ(failed.exit_code, 1);
  EXPECT_THAT(failed.err, HasSubstr("ffmpeg could not write it; "));
  EXPECT_TRUE(made().empty());
}

TEST_F(Film, ThatIsStoppedLeavesNothingAndNobodyAtWork) {
  const Outcome stopped = film(
      "echo $$ >ffmpeg.process; exec sleep 300\n",
      " & pid=$!; for i in $(seq 1200); do [ -s ffmpeg.process ] && break; sleep 0.05; done; kill -TERM $pid; wait "
      "$pid; "
      "echo exit code $?; sleep 0.5; case \"$(sed -n 's/^State:[[:space:]]*//p' /proc/$(cat ffmpeg.process)/status "
      "2>/dev/null)\" in ''|Z*|X*) ;; *) echo goes on;; esac");
  EXPECT_THAT(stopped.out, AllOf(HasSubstr("exit code 143"), ::testing::Not(HasSubstr("goes on")))) << stopped.err;
  EXPECT_TRUE(made().empty()) << made().front();
  EXPECT_EQ(film("cat >&3\n", "").exit_code, 0) << "again, as if it had not been stopped";
}

}  // namespace
}  // namespace burin
