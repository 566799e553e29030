// Proves: a wall's pictures are cut over its boards so that what lies behind gaps is lost; eyes and lamps keep their
// places; one board is worked on by one process; and whatever is killed, and however many workers there are, the
// scratches and the G-code have the same bits.
#include <gmock/gmock.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <map>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "burin/base/error.h"
#include "burin/base/srgb.h"
#include "burin/pictures/picture.h"
#include "burin/scene/bench_of_board.h"
#include "tests/places.h"
#include "tests/temporary_folder.h"
#include "tests/tools/program.h"
#include "tools/wall/claim.h"
#include "tools/wall/lay_wall.h"
#include "tools/wall/wall_file.h"

namespace burin {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

// ---- pictures ----

// Light that rises linearly from 0 at the left to 1 at the right.
Image ramp(int width, int height) {
  Image out(width, height, 1);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) out.at(x, y) = static_cast<float>((x + 0.5) / width);
  return out;
}

TEST(WallPictures, WhatLiesBehindAGapIsLost) {
  // Two boards of 40 mm with 20 mm between them, under a picture that is 100 mm wide.
  const Image picture = ramp(1000, 300);
  const WallArea wall{{0, 0}, {100, 30}};
  const LaidPicture laid = laid_picture(1000, 300, Fit::cover, Keep::middle, 0, wall.size_mm());
  const Image left = picture_on_board(picture, laid, wall, {{0, 0}, {40, 30}}),
              right = picture_on_board(picture, laid, wall, {{60, 0}, {100, 30}});
  const auto at = [](const Image& part, double share) {
    return srgb_to_linear(part.at(static_cast<int>(share * part.width), part.height / 2));
  };
  constexpr double kPixel = 2.0 / 1000;
  EXPECT_NEAR(at(left, 0.5), 0.2, kPixel);
  EXPECT_NEAR(at(left, 0.999), 0.4, kPixel);
  EXPECT_NEAR(at(right, 0.0), 0.6, kPixel);
  EXPECT_NEAR(at(right, 0.5), 0.8, kPixel);
  // The part has the board's shape, so that the design crops nothing of it.
  EXPECT_NEAR(static_cast<double>(left.width) / left.height, 4.0 / 3, 0.001);
}

TEST(WallPictures, PartsOfAPixelCountByTheirArea) {
  Image picture(4, 1, 1);
  picture.data = {1, 0, 0.5F, 0.25F};
  const Image part = part_of_picture(picture, {0.5, 0}, {3.5, 1}, 1, 1);
  EXPECT_NEAR(part.at(0, 0), (0.5 * 1 + 0 + 0.5 + 0.5 * 0.25) / 3, 1e-6);
  const Image beside = part_of_picture(picture, {-2, 0}, {2, 1}, 2, 1);  // black outside
  EXPECT_NEAR(beside.at(0, 0), 0, 1e-6);
  EXPECT_NEAR(beside.at(1, 0), 0.5, 1e-6);
}

// ---- layouts ----

TEST(WallLayout, GridsHaveTheirGaps) {
  const std::vector<WallBoard> boards = grid_of_boards(3, 2, {40, 30}, 5);
  ASSERT_EQ(boards.size(), 6U);
  EXPECT_EQ(boards[0].name, "r1c1");
  EXPECT_EQ(boards[0].corner_mm, Eigen::Vector2d(0, 35));  // the upper row comes first
  EXPECT_EQ(boards[5].name, "r2c3");
  EXPECT_EQ(boards[5].corner_mm, Eigen::Vector2d(90, 0));
}

TEST(WallLayout, DrawingsGiveTheirRectangles) {
  const TemporaryFolder folder;
  folder.write("a.svg",
               R"(<svg width="200mm" height="100mm" viewBox="0 0 400 200"><rect id="big" x="20" y="10" width="200" )"
               R"(height="180"/><rect x="240" y="110" width="80" height="80"/></svg>)");
  const std::vector<WallBoard> boards = boards_of_drawing(folder / "a.svg");
  ASSERT_EQ(boards.size(), 2U);
  EXPECT_EQ(boards[0].name, "big");
  EXPECT_EQ(boards[0].corner_mm, Eigen::Vector2d(0, 0));
  EXPECT_EQ(boards[0].size_mm, Eigen::Vector2d(100, 90));
  EXPECT_EQ(boards[1].name, "b2");
  EXPECT_EQ(boards[1].corner_mm, Eigen::Vector2d(110, 0));
  folder.write("b.svg", R"(<svg><rect width="9" height="9"/><rect x="5" width="9" height="9"/></svg>)");
  EXPECT_THAT([&] { boards_of_drawing(folder / "b.svg"); }, ThrowsMessage<Error>(HasSubstr("overlap")));
  folder.write("c.svg", "<svg><g transform='scale(2)'><rect width='9' height='9'/></g></svg>");
  EXPECT_THAT([&] { boards_of_drawing(folder / "c.svg"); }, ThrowsMessage<Error>(HasSubstr("transform")));
}

// ---- claims ----

TEST(WallClaims, OneBoardIsOneWorkers) {
  const TemporaryFolder folder;
  {
    const auto first = Claim::make(folder.path(), "a", "preview", 1);
    ASSERT_TRUE(first);
    EXPECT_FALSE(Claim::make(folder.path(), "a", "preview", 1));
    EXPECT_TRUE(Claim::make(folder.path(), "b", "preview", 1));
    const LatestClaim claim = read_claims(folder.path()).at("a");
    EXPECT_EQ(claim.text->state, ClaimState::working);
    EXPECT_EQ(claim.text->process, ::getpid());
    EXPECT_FALSE(has_ended_here(*claim.text));
    first->end(ClaimState::failed, "no tags \" \xff" + std::string(2000, 'x'));
  }
  const LatestClaim ended = read_claims(folder.path()).at("a");
  EXPECT_EQ(ended.text->state, ClaimState::failed);
  EXPECT_THAT(ended.text->words, HasSubstr("no tags"));
  EXPECT_EQ(read_claims(folder.path()).at("b").text->state, ClaimState::stopped);  // its owner went without a word
}

TEST(WallClaims, OnlyASilentWorkerIsDead) {
  LatestClaim claim{1, ClaimText{}};
  claim.text->machine = "another";
  Heartbeats heartbeats;
  const std::chrono::seconds now(0);
  EXPECT_FALSE(heartbeats.is_dead("a", claim, now + std::chrono::seconds(100)));
  std::this_thread::sleep_for(std::chrono::milliseconds(5));
  EXPECT_TRUE(heartbeats.is_dead("a", claim, now));
  claim.text->pulse = 1;
  EXPECT_FALSE(heartbeats.is_dead("a", claim, now));  // it is seen for the first time
  const LatestClaim unreadable{2, std::nullopt};
  EXPECT_FALSE(heartbeats.is_dead("a", unreadable, now));
}

// ---- whole walls ----

const fs::path kTargets = fs::path(places::source()) / "samples" / "small-bench" / "targets";

std::vector<std::string> tiny_wall(const std::string& name) {
  return {"wall",
          "new",
          name,
          "--grid",
          "2x1",
          "--board",
          "40x30",
          "--gap",
          "4mm",
          "--pictures",
          (kTargets / "moon.png").string(),
          (kTargets / "boat.png").string(),
          "--count",
          "120",
          "--border",
          "2mm",
          "--stand",
          "600mm"};
}

// Fewer iterations: the test is about who works, and not about quality.
void make_quick(const TemporaryFolder& folder, const std::string& wall) {
  for (const char* board : {"r1c1", "r1c2"}) {
    const fs::path file = folder / wall / board / "loop.toml";
    folder.write(wall + "/" + board + "/loop.toml", file_text(file) + "iterations = 6\n");
  }
}

std::map<std::string, std::string> results_of(const TemporaryFolder& folder, const std::string& wall) {
  std::map<std::string, std::string> results;
  for (const char* board : {"r1c1", "r1c2"})
    for (const char* file : {"design.json", "round-01/scratches.csv", "round-01/sent.csv", "round-01/board.gcode"})
      results[std::string(board) + "/" + file] = file_text(folder / wall / board / file);
  return results;
}

pid_t start_worker(const TemporaryFolder& folder, const std::string& wall, const std::string& threads) {
  const pid_t worker = ::fork();
  if (worker != 0) return worker;
  const std::string log = (folder / ("log-" + std::to_string(::getpid()))).string();
  if (::chdir(folder.path().c_str()) != 0 || !std::freopen(log.c_str(), "w", stdout) ||
      !std::freopen(log.c_str(), "a", stderr))
    ::_exit(99);
  ::execl(places::program().c_str(), "burin", "--threads", threads.c_str(), "wall", "work", wall.c_str(), nullptr);
  ::_exit(98);
}

int exit_of(pid_t worker) {
  int status = 0;
  ::waitpid(worker, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
}

TEST(Walls, NobodysDeathChangesABit) {
  const TemporaryFolder folder;
  const Outcome made = run_burin(folder, tiny_wall("one"));
  ASSERT_EQ(made.exit_code, 0) << made.err;
  make_quick(folder, "one");
  const auto began = std::chrono::steady_clock::now();
  const Outcome alone = run_burin(folder, {"wall", "work", "one"});
  ASSERT_EQ(alone.exit_code, 0) << alone.err;
  const double whole_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  const auto expected = results_of(folder, "one");
  EXPECT_GT(expected.at("r1c2/round-01/board.gcode").size(), 100U);

  for (const unsigned seed : {1U, 2U, 3U}) {
    const std::string wall = "killed-" + std::to_string(seed);
    ASSERT_EQ(run_burin(folder, tiny_wall(wall)).exit_code, 0);
    make_quick(folder, wall);
    std::mt19937 random(seed);
    std::vector<pid_t> workers;
    for (int kill = 0; kill < 4; ++kill) {
      while (workers.size() < 2) workers.push_back(start_worker(folder, wall, std::to_string(workers.size() + 1)));
      std::this_thread::sleep_for(std::chrono::duration<double>(whole_s / 4 * (random() % 1000) / 1000));
      const std::size_t victim = random() % 2;
      ::kill(workers[victim], SIGKILL);
      exit_of(workers[victim]);
      workers.erase(workers.begin() + static_cast<std::ptrdiff_t>(victim));
    }
    workers.push_back(start_worker(folder, wall, "2"));
    for (const pid_t worker : workers) EXPECT_EQ(exit_of(worker), 0);
    EXPECT_EQ(results_of(folder, wall), expected) << seed;
    const Outcome status = run_burin(folder, {"wall", "status", wall});
    EXPECT_THAT(status.out, HasSubstr("2 ready"));
  }
}

TEST(Walls, ViewsAndLampsStayWhereTheyAre) {
  const TemporaryFolder folder;
  ASSERT_EQ(run_burin(folder, tiny_wall("w")).exit_code, 0);
  const Wall wall = read_wall(folder / "w");
  for (const WallBoard& on_wall : wall.boards) {
    const fs::path project = folder / "w" / on_wall.name;
    const Bench bench =
        read_bench_of(read_board(project / "board.json"), project / "board.json", project / "bench.json");
    const Eigen::Vector3d corner(on_wall.corner_mm.x(), on_wall.corner_mm.y(), 0);
    for (std::size_t k = 0; k < wall.views.size(); ++k)
      EXPECT_LT((bench.views[k].T_camera_board.inverse().translation() + corner - wall.views[k].eye_mm).norm(), 1e-6);
    EXPECT_EQ(bench.lights[0].position_mm.x() + corner.x(), wall.lights[0]["position_mm"][0].get<double>());
  }
}

TEST(Walls, ChangesAndOtherProgramsAreRefused) {
  const TemporaryFolder folder;
  ASSERT_EQ(run_burin(folder, tiny_wall("w")).exit_code, 0);
  const std::string text = file_text(folder / "w/wall.json");
  folder.write("w/wall.json", text + "\n");
  EXPECT_THAT(run_burin(folder, {"wall", "work", "w"}).err, HasSubstr("burin wall lay"));
  EXPECT_EQ(run_burin(folder, {"wall", "lay", "w"}).exit_code, 0);
  EXPECT_THAT(run_burin(folder, {"wall", "settle", "w"}).err, HasSubstr("has no preview yet"));
  fs::create_directory(folder / "w/claims");
  folder.write("w/claims/program.json",
               R"({"format": "burin/wall-program", "version": 1, "burin": "9.9.9", "simd": "sse2"})");
  const Outcome other = run_burin(folder, {"wall", "work", "w"});
  EXPECT_EQ(other.exit_code, 1);
  EXPECT_THAT(other.err, HasSubstr("9.9.9"));
}

TEST(Walls, BadInputIsNamed) {
  const TemporaryFolder folder;
  std::vector<std::string> wide = tiny_wall("w");
  wide[8] = "50mm";
  EXPECT_THAT(run_burin(folder, wide).err, HasSubstr("wider than a board"));
  ASSERT_EQ(run_burin(folder, tiny_wall("w")).exit_code, 0);
  const std::string text = file_text(folder / "w/wall.json");
  const auto refused = [&](const std::string& from, const std::string& to, const std::string& words) {
    std::string changed = text;
    changed.replace(changed.find(from), from.size(), to);
    folder.write("w/wall.json", changed);
    EXPECT_THAT([&] { read_wall(folder / "w"); }, ThrowsMessage<Error>(HasSubstr(words))) << words;
  };
  refused("\"r1c2\"", "\"r1c1\"", "two boards are named r1c1");
  refused("\"r1c2\"", "\"../up\"", "cannot be its folder");
  refused("\"scratches\"", "\"scratch\"", "machine_hours");
  refused("\"border_mm\"", "\"tags_mm\"", "border_mm");
  refused("\"border_mm\": 2.0", "\"border_mm\": 0.1", "run off the sheets");
}

}  // namespace
}  // namespace burin
