// Proves: what would ruin a machine or a sheet is not given out, however a profile's blocks are written and whatever
// files hold; ways clear the face, clamps and the tags' paper; the first way comes from above.
#include "burin/optimize/toolpath/release_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "burin/base/error.h"
#include "burin/base/files/json_file.h"
#include "burin/optimize/toolpath.h"
#include "burin/optimize/toolpath/probe.h"
#include "burin/optimize/toolpath/probe_check.h"
#include "tests/temporary_folder.h"

namespace burin {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::ThrowsMessage;

Board sheet_of_120() {
  Board board;
  board.size_mm = {120, 120};
  board.carve_min_mm = {20, 20};
  board.carve_max_mm = {100, 100};
  board.material.depth_um = 11;
  board.tags.list = {{0, {10, 10}, 6, 0}, {1, {110, 110}, 6, 0}};
  return board;
}

// Two on the left of the carve area, two on the right.
Scratches four_scratches(double depth_um = 0) {
  Scratches s;
  s.x0_mm = {30, 32, 90, 88}, s.y0_mm = {30, 40, 30, 40};
  s.x1_mm = {35, 36, 95, 92}, s.y1_mm = {33, 41, 31, 42};
  if (depth_um > 0) s.depth_um.assign(4, depth_um);
  return s;
}

std::string made(const Board& board, const MachineProfile& machine, const Scratches& scratches,
                 ToolpathOptions options = {}, const Bench* bench = nullptr) {
  options.keep_order = true;
  return gcode_parts(plan_toolpath(scratches, board, bench, machine, options), machine).front().text;
}

void replace_all(std::string& text, const std::string& what, const std::string& by) {
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += by.size())
    text.replace(at, what.size(), by);
}

// What speaks against a file on this board.
std::string against(const std::string& text, const Board& board, const MachineProfile& machine, const Face& face = {}) {
  std::string all;
  try {
    for (const Finding& f : check_release(text, machine, workpiece_of(board, nullptr), face, "f.nc").faults)
      all += sentence(f) + "\n";
  } catch (const Error& error) {
    all = error.what();
  }
  return all;
}

TEST(ReleaseCheck, NoTipGoesDeeperThanItIs) {
  Board board = sheet_of_120();
  const MachineProfile grbl = machine_profile("grbl");
  const std::string good = made(board, grbl, four_scratches(99));
  EXPECT_THAT(good, HasSubstr("G1 Z-0.0990"));
  EXPECT_EQ(against(good, board, grbl), "");
  EXPECT_THAT([&] { made(board, grbl, four_scratches(110)); }, ThrowsMessage<Error>(HasSubstr("wt / 4")));
  board.tool_width_um = 200;  // another cutter
  EXPECT_THAT(against(good, board, grbl), AllOf(HasSubstr("f.nc:"), HasSubstr("Z-0.0990, deeper below the face")));
  board.material.depth_um = 50000;
  EXPECT_THAT([&] { made(board, grbl, four_scratches()); }, ThrowsMessage<Error>(HasSubstr("Z-50.0000")));
}

TEST(ReleaseCheck, NoSpringIsPressedBeyondItsTable) {
  const Board board = sheet_of_120();
  const MachineProfile spring = machine_profile("grbl-spring");
  std::string text = made(board, spring, four_scratches());
  EXPECT_EQ(against(text, board, spring), "");
  const std::size_t z = text.find("G1 Z-");
  text.replace(z, text.find(' ', z + 4) - z, "G1 Z-2.5");
  EXPECT_NE(against(text, board, spring), "");
}

// The replay looks at what the lines do, whatever the blocks that they came from.
TEST(ReleaseCheck, BelowTheFaceIsMetalInEveryProfile) {
  const Board board = sheet_of_120();
  MachineProfile machine = machine_profile("grbl");
  machine.per_scratch = {"G0 X{x0} Y{y0}", "G1 Z-{depth_um} F{plunge_feed}", "G1 X{x1} Y{y1} F{feed}", "G0 Z{z_safe}"};
  EXPECT_THAT([&] { made(board, machine, four_scratches()); }, ThrowsMessage<Error>(HasSubstr("Z-11")));
  // A head that presses by itself carves above the face, and is never sent below it by G0.
  machine.per_scratch = {"G0 X{x0} Y{y0}", "M3 S350", "G1 X{x1} Y{y1} F{feed}", "M5"};
  std::string text = made(board, machine, four_scratches());
  EXPECT_EQ(against(text, board, machine), "");
  replace_all(text, "G0 Z1.0000", "G0 Z-40.0000");
  EXPECT_THAT(against(text, board, machine), HasSubstr("into the metal with G0"));

  MachineProfile servo = machine_profile("grbl");
  servo.depth_by = DepthBy::servo;
  servo.depth_table.rows = {{5, 300}, {20, 900}};
  servo.dwell_s = 0.2;
  servo.per_scratch = {"G0 X{x0} Y{y0}", "M3 S{servo}", "G4 P{dwell_s}", "G1 X{x1} Y{y1} F{feed}", "M3 S{servo_up}"};
  servo.start = {"G21 G90", "G0 Z{z_safe}", "M3 S0"};
  EXPECT_EQ(against(made(board, servo, four_scratches()), board, servo), "");
  servo.start = {"G21 G90", "M3 S0", "G0 Z-20"};
  EXPECT_THAT([&] { made(board, servo, four_scratches()); }, ThrowsMessage<Error>(HasSubstr("below the face")));
  servo.start = {"G21 G90", "M3 S0", "G0 Z5", "G53 G0 Z-80"};
  EXPECT_THAT([&] { made(board, servo, four_scratches()); }, ThrowsMessage<Error>(HasSubstr("G53")));
}

TEST(ReleaseCheck, WhatIsSentLiesOnTheSheet) {
  const Board board = sheet_of_120();
  const MachineProfile grbl = machine_profile("grbl");
  Bench bench;
  bench.material = board.material;
  bench.machine_affine << 1, 0, 40, 0, 1, 0;  // no reader takes it
  EXPECT_THAT([&] { made(board, grbl, four_scratches(), {}, &bench); },
              ThrowsMessage<Error>(HasSubstr("off the sheet")));
  bench.machine_affine << 1.002, 0, 0.3, 0, 0.999, -0.2;
  EXPECT_NO_THROW(made(board, grbl, four_scratches(), {}, &bench));
  for (const char* way : {"G0 X-200 Y-200", "G0 X126", "G0 Y-6", "G0 X95000", "G0 Z200"}) {
    std::string text = made(board, grbl, four_scratches());
    text.insert(text.rfind("G0 Z"), std::string(way) + "\n");
    EXPECT_THAT(against(text, board, grbl), AnyOf(HasSubstr("off the sheet"), HasSubstr("higher than a machine")))
        << way;
  }
}

// A height map whose column at x = 51.5 mm is 6 mm high, and which is even elsewhere.
HeightMap with_thin_column() {
  HeightMap map;
  map.columns = map.rows = 161;
  map.first_mm = map.zero_mm = {20, 20};
  map.step_mm = {0.5, 0.5};
  map.z_mm.assign(161 * 161, 0);
  map.probed.assign(map.z_mm.size(), true);
  for (int r = 0; r < 161; ++r) map.z_mm[static_cast<std::size_t>(r) * 161 + 63] = 6;
  return map;
}

TEST(ReleaseCheck, EveryGridLineOfAHeightMapIsLookedAt) {
  const Board board = sheet_of_120();
  const MachineProfile grbl = machine_profile("grbl");
  ToolpathOptions options;
  options.heights = with_thin_column();
  std::string text = made(board, grbl, four_scratches(), options);
  const Face face{options.heights, {}, CarvingLimits().affine, {20, 20}};
  EXPECT_THAT(text, HasSubstr("G0 Z7.0000"));  // over the column, between the two
  const Replay replay = replay_gcode(text, grbl, "f", &face);
  EXPECT_NEAR(replay.lowest_travel_mm, 1, 1e-9);
  replace_all(text, "G0 Z7.0000", "G0 Z1.0000");
  EXPECT_THAT(against(text, board, grbl, face), HasSubstr("high place of the face"));
}

TEST(ReleaseCheck, HeightsAlongAWayAreExact) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> z(-0.3, 0.3), at(-5, 45);
  HeightMap map;
  map.columns = 9, map.rows = 6;
  map.step_mm = {5, 7};
  for (int i = 0; i < 54; ++i) map.z_mm.push_back(z(random)), map.probed.push_back(true);
  Face face;
  face.map = map;
  Face bowed;
  bowed.bow = Surface{{40, 35}, {0.2, -0.1, 0.15}};
  bowed.zero_mm = {5, 5};
  for (int k = 0; k < 200; ++k) {
    const Face& f = k % 3 == 0 ? bowed : face;
    const Eigen::Vector3d a(at(random), at(random), z(random)), b(at(random), at(random), z(random));
    const HeightRange range = height_above(f, a, b);
    double least = INFINITY, most = -INFINITY;
    constexpr int kLooks = 2000;
    for (int i = 0; i <= kLooks; ++i) {
      const Eigen::Vector3d p = a + i / double(kLooks) * (b - a);
      const double above = p.z() - height_mm(f, p.head<2>());
      least = std::min(least, above), most = std::max(most, above);
    }
    EXPECT_NEAR(range.least_mm, least, 2e-3);
    EXPECT_LE(range.least_mm, least + 1e-12);
    EXPECT_NEAR(range.most_mm, most, 2e-3);
    EXPECT_GE(range.most_mm, most - 1e-12);
  }
}

TEST(ReleaseCheck, WaysLiftOverClampsAndNobodyGuessesTheirHeight) {
  const TemporaryFolder folder;
  Board board = sheet_of_120();
  board.keep_out = {{"clamp", {{50, 20}, {70, 20}, {70, 100}, {50, 100}}, {0, 0}, 0}};
  for (const char* name : {"grbl", "marlin", "linuxcnc", "grbl-spring"}) {
    const MachineProfile machine = machine_profile(name);
    ToolpathOptions options;
    options.frame = true;
    board.keep_out[0].height_mm.reset();
    const auto write = [&] {
      return write_toolpath(four_scratches(), board, nullptr, machine, options,
                            folder / (std::string(name) + ".gcode"));
    };
    EXPECT_THAT(write, ThrowsMessage<Error>(AllOf(HasSubstr("clamp"), HasSubstr("\"height_mm\""))));
    board.keep_out[0].height_mm = 12;
    const ToolpathReport report = write();
    for (const auto& file : report.files) {
      std::string text = read_text(file);
      EXPECT_EQ(against(text, board, machine), "") << text;
      // Each way above the rectangle is as high as it and a millimeter more.
      std::size_t over = 0;
      replay_gcode(text, machine, "f", nullptr, [&](const ToolWay& way) {
        if (!way.from_mm.allFinite() || (way.from_mm.x() > 50 && way.to_mm.x() > 50)) return;
        if (way.from_mm.x() < 70 && way.to_mm.x() < 70) return;
        ++over;
        EXPECT_GE(std::min(way.from_mm.z(), way.to_mm.z()), 13 - 1e-9) << text;
      });
      EXPECT_GT(over, 0u);
      replace_all(text, "Z13.0", "Z11.0");
      replace_all(text, "Z18.0", "Z11.0");
      EXPECT_THAT(against(text, board, machine), HasSubstr("f.nc:"));
    }
    // Nothing stands in a hole.
    board.keep_out[0].height_mm = 0;
    EXPECT_THAT(read_text(write().files[0]), Not(HasSubstr("Z13")));
  }
}

// Z of a servo's head stays while it carves: it presses from there, so a clamp lifts it for the way across alone.
TEST(ReleaseCheck, AServosHeadIsLiftedOverAClampAndComesBackToItsHeight) {
  Board board = sheet_of_120();
  board.keep_out = {{"clamp", {{50, 20}, {70, 20}, {70, 100}, {50, 100}}, {0, 0}, 0, 12}};
  const TemporaryFolder folder;
  for (const std::string based_on : {"grbl", "marlin", "linuxcnc"})
    for (const std::string table :
         {R"("servo_up":0,"depth_table":[[5,300],[20,900]])", R"("servo_up":1000,"depth_table":[[5,900],[20,100]])"}) {
      if (based_on == "linuxcnc" && table.find("1000") != std::string::npos) continue;  // its M2 would press the head
      MachineProfile servo = read_machine_profile(
          folder.write("m.json", R"({"format":"burin/machine","version":1,"depth_by":"servo","dwell_s":0.2,)" + table +
                                     R"(,"based_on":")" + based_on + "\"}"));
      ToolpathOptions options;
      options.frame = true;
      options.keep_order = true;  // left to right, twice over the clamp and more
      const ToolpathReport report = write_toolpath(four_scratches(), board, nullptr, servo, options,
                                                   folder / (based_on + std::to_string(table.size()) + ".gcode"));
      for (const auto& file : report.files) EXPECT_EQ(against(read_text(file), board, servo), "") << read_text(file);
      const std::string text = read_text(report.files[0]);
      std::size_t over = 0;
      replay_gcode(text, servo, "f", nullptr, [&](const ToolWay& way) {
        if (way.carves) {
          EXPECT_EQ(way.from_mm.z(), servo.safe_z_mm) << text;
        }
        if (way.from_mm.allFinite() && (way.from_mm.x() < 50) != (way.to_mm.x() < 50)) {
          ++over;
          EXPECT_EQ(way.to_mm.z(), 13) << text;
        }
      });
      EXPECT_GT(over, 0u);
      // A head without a Z axis goes only as high as its servo lifts it.
      std::erase_if(servo.start, [](const std::string& line) { return line.find('Z') != std::string::npos; });
      std::erase_if(servo.end, [](const std::string& line) { return line.find('Z') != std::string::npos; });
      EXPECT_THAT([&] { made(board, servo, four_scratches()); },
                  ThrowsMessage<Error>(HasSubstr("clears the sheet and its clamps from Z13.00")));
      servo.safe_z_mm = 15;
      EXPECT_NO_THROW(made(board, servo, four_scratches()));
    }
}

TEST(ReleaseCheck, TheFirstWayComesFromAboveAndSaysSo) {
  const Board board = sheet_of_120();
  for (const char* name : {"grbl", "marlin", "linuxcnc", "grbl-spring", "laser-z"}) {
    const MachineProfile machine = machine_profile(name);
    std::string text = made(board, machine, four_scratches());
    EXPECT_THAT(text, HasSubstr("first way along X and Y: 5.3 mm above zero, over sheet and clamps"));
    EXPECT_LT(text.find("G0 Z5.3"), text.find("G0 X"));
    replace_all(text, "Z5.3", "Z1.0");
    EXPECT_THAT(against(text, board, machine), HasSubstr("a place that is not in the file, at Z1.00"));
  }
  MachineProfile own = machine_profile("grbl");
  own.start = {"G21 G90", "G0 Z1"};
  EXPECT_THAT([&] { made(board, own, four_scratches()); }, ThrowsMessage<Error>(HasSubstr("lift to {z_safe}")));
  // A head whose Z stays comes down to its height over its first scratch.
  own = machine_profile("grbl");
  own.per_scratch = {"G0 X{x0} Y{y0}", "M3 S350", "G1 X{x1} Y{y1} F{feed}", "M5"};
  EXPECT_THAT(made(board, own, four_scratches()), HasSubstr("G0 Z5.3000\nG0 X30.0000 Y30.0000\nG0 Z1.0000\n"));
}

TEST(ReleaseCheck, TravelClearsTheTagsPaper) {
  Board board = sheet_of_120();
  MachineProfile machine = machine_profile("grbl");
  machine.safe_z_mm = 0.05;
  for (const char* last : {"G0 Z{z_safe}", "G0 Z0.05"}) {  // the second leaves it to the ways between
    machine.per_scratch.back() = last;
    std::string text = made(board, machine, four_scratches());
    EXPECT_EQ(against(text, board, machine), "");
    EXPECT_THAT(text, HasSubstr("G0 Z0.3000"));
    replace_all(text, "G0 Z0.3000", "G0 Z0.0500");
    EXPECT_THAT(against(text, board, machine), HasSubstr("0.10 mm thick"));
  }
}

TEST(ReleaseCheck, LinesAndFilesAreAsLongAsTheMachineTakesThem) {
  const Board board = sheet_of_120();
  MachineProfile machine = machine_profile("grbl");
  machine.max_line_characters = 40;
  std::istringstream lines(made(board, machine, four_scratches()));
  for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 40u);
  machine.max_lines = 12;
  EXPECT_THAT([&] { made(board, machine, four_scratches()); }, ThrowsMessage<Error>(HasSubstr("max_lines")));
}

TEST(ReleaseCheck, AReachThatNobodySaidIsNamed) {
  MachineProfile machine = machine_profile("grbl");
  ASSERT_EQ(reach_findings(machine).size(), 1u);
  EXPECT_THAT(sentence(reach_findings(machine)[0]), HasSubstr("travel_mm"));
  machine.travel_is_unknown = true;  // an answer, too
  EXPECT_TRUE(reach_findings(machine).empty());
  machine.travel_is_unknown = false;
  machine.travel = MachineBounds{{0, 0}, {300, 180}};
  EXPECT_TRUE(reach_findings(machine).empty());
}

TEST(ReleaseCheck, ProbingLiftsOverClampsAndTouchesSlowly) {
  Board board = sheet_of_120();
  board.keep_out = {{"clamp", {{50, 20}, {70, 20}, {70, 100}, {50, 100}}, {0, 0}, 0, 12}};
  MachineProfile machine = machine_profile("grbl");
  machine.acceleration_z_mm_s2 = 1e6;
  const ProbePlan plan = probe_plan(board, 15);
  std::string text = probe_gcode(plan, machine);
  EXPECT_THAT(text, AllOf(HasSubstr("G0 Z13.0000"), HasSubstr("F60\n"), Not(HasSubstr("F18"))));
  EXPECT_NO_THROW(fail_unless_probes(text, plan, machine, "p.nc"));
  std::string low = text, fast = text;
  replace_all(low, "G0 Z13.0000", "G0 Z2.0000");
  EXPECT_THAT([&] { fail_unless_probes(low, plan, machine, "p.nc"); }, ThrowsMessage<Error>(HasSubstr("travels 2.00")));
  replace_all(fast, "F60", "F1897");
  EXPECT_THROW(fail_unless_probes(fast, plan, machine, "p.nc"), Error);
  for (const double spacing : {1e-9, 5e-324, 0.01})
    EXPECT_THAT([&] { probe_plan(board, spacing); }, ThrowsMessage<Error>(HasSubstr("greater distance"))) << spacing;
}

std::string heights_text(const std::function<double(int, int)>& z, const std::string& zero = "[20, 20]") {
  std::string rows;
  for (int r = 0; r < 9; ++r) {
    rows += r == 0 ? "[" : ", [";
    for (int c = 0; c < 9; ++c) rows += (c == 0 ? "" : ", ") + std::to_string(z(r, c));
    rows += "]";
  }
  return R"({"format": "burin/heights", "version": 1, "zero_mm": )" + zero +
         R"(, "first_mm": [20, 20], "step_mm": [10, 10], "z_mm": [)" + rows + "]}";
}

TEST(ReleaseCheck, HeightsThatNoSheetHasAreRefused) {
  const TemporaryFolder folder;
  const auto refuses = [&](const std::string& text, const std::string& why) {
    EXPECT_THAT([&] { read_heights(folder.write("h.json", text)); }, ThrowsMessage<Error>(HasSubstr(why))) << text;
  };
  const auto gentle = [](int r, int c) { return 0.002 * r + 0.004 * c; };
  EXPECT_NO_THROW(read_heights(folder.write("h.json", heights_text(gentle))));
  refuses(heights_text([](int, int) { return -1000; }), "and not at 0");
  refuses(heights_text([](int, int) { return -1; }), "and not at 0");
  refuses(heights_text([](int, int c) { return 6.25 * c; }), "tilts by");
  refuses(heights_text(gentle, "[1e6, 1e6]"), "beyond the grid");
  refuses(heights_text([&](int r, int c) { return r == 4 && c == 4 ? 6 : gentle(r, c); }), "above the smooth face");
  refuses(heights_text([&](int, int c) { return c > 4 ? 1.0 : 0.0; }), "");  // two sheets
  refuses(heights_text([&](int, int c) { return c > 4 ? 0.3 : 0.0; }), "");
  // More points than any probing has, half of them missing.
  std::string many =
      R"({"format": "burin/heights", "version": 1, "zero_mm": [0, 0], "first_mm": [0, 0], "step_mm": [1, 1],
                         "z_mm": [)";
  for (int r = 0; r < 600; ++r) {
    many += r == 0 ? "[" : ",[";
    for (int c = 0; c < 600; ++c) many += c == 0 ? "0" : (r + c) % 2 == 0 ? ",0" : ",null";
    many += "]";
  }
  refuses(many + "]}", "40,000");
}

}  // namespace
}  // namespace burin
