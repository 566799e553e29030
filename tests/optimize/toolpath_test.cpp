// Proves: what comes out of a file, read back by an independent path (replay of G-code, the numbers of SVG and DXF), is
// what was designed, once each, not mirrored; a machine with a known fault carves the design after compensation; parts
// can be started on their own; every input that cannot be carved is refused by name.
#include "burin/optimize/toolpath.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <regex>
#include <sstream>

#include "burin/base/error.h"
#include "burin/optimize/toolpath/toolpath_check.h"
#include "burin/scene/parameter_name.h"
#include "tests/optimize/carving_bench.h"
#include "tests/temporary_folder.h"

namespace burin {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::ThrowsMessage;

Scratches some_scratches(std::size_t count) { return random_scratches(count, 11, {15, 15}, {185, 85}, 4); }

Bench bench_with_machine(const Affine2& affine) {
  Bench bench;
  bench.machine_affine = affine;
  return bench;
}

std::size_t count_of(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + part.size())) ++count;
  return count;
}

/// Largest distance between the scratches as designed and as found, matched by row (either end first).
double worst_mm(const Scratches& designed, const std::vector<CarvingStep>& order,
                const std::vector<std::array<double, 4>>& found) {
  double worst = designed.size() == found.size() ? 0 : 1e9;
  for (std::size_t k = 0; k < std::min(order.size(), found.size()); ++k) {
    const std::size_t i = order[k].scratch;
    std::array<double, 4> expected{designed.x0_mm[i], designed.y0_mm[i], designed.x1_mm[i], designed.y1_mm[i]};
    if (order[k].reversed) expected = {expected[2], expected[3], expected[0], expected[1]};
    for (int c = 0; c < 4; ++c) worst = std::max(worst, std::abs(expected[c] - found[k][c]));
  }
  return worst;
}

TEST(Toolpath, GcodeOfEveryMachineIsTheDesignReplayed) {
  const TemporaryFolder folder;
  const Scratches s = some_scratches(500);
  for (const char* name : {"grbl", "linuxcnc", "marlin"}) {
    const MachineProfile machine = machine_profile(name);
    const auto file = folder / (std::string(name) + ".gcode");
    const ToolpathReport report = write_toolpath(s, board_200x100(), nullptr, machine, {}, file);
    ASSERT_EQ(report.files, std::vector{file});
    const std::string text = file_text(file);
    const Replay replay = replay_gcode(text, machine, name);
    std::vector<std::array<double, 4>> found;
    for (const ReplayedScratch& r : replay.scratches) {
      found.push_back({r.from_mm.x(), r.from_mm.y(), r.to_mm.x(), r.to_mm.y()});
      EXPECT_NEAR(r.depth_mm, 0.014, 1e-4);
    }
    EXPECT_LT(worst_mm(s, report.order, found), 0.51e-4) << name;  // four decimals
    EXPECT_THAT(text, AllOf(HasSubstr("G21"), HasSubstr("G90")));
    EXPECT_NEAR(replay.min_mm.z(), -0.014, 1e-9);
    EXPECT_NEAR(replay.max_mm.z(), kFirstWay_mm, 1e-9);  // the first way, and behind the last scratch
    EXPECT_NEAR(replay.lowest_travel_mm, machine.safe_z_mm, 1e-9);
    EXPECT_NEAR(report.duration_s, replay.duration_s, 1e-9);
    EXPECT_LT(report.travel_mm, report.file_order_travel_mm);
    for (std::istringstream lines(text); lines;) {
      std::string line;
      std::getline(lines, line);
      EXPECT_LT(line.size(), 80u);  // grbl's line buffer
    }
  }
}

TEST(Toolpath, TheEstimateIsTheReplaysTime) {
  // Two independent sums: over planned scratches, and over the moves of the file.
  const Scratches s = some_scratches(300);
  MachineProfile machine = machine_profile("grbl");
  machine.dwell_s = 0.25;
  const Toolpath path = plan_toolpath(s, board_200x100(), nullptr, machine);
  const auto parts = gcode_parts(path, machine);
  ASSERT_EQ(parts.size(), 1u);
  EXPECT_EQ(count_of(parts[0].text, "G4 P0.250"), 300u);
  // They differ by the first lift and the way to the first scratch, whose beginnings the file does not tell.
  EXPECT_NEAR(parts[0].duration_s, path.duration_s, 5);
  EXPECT_GT(path.duration_s, 300 * 0.25);
  machine.acceleration_mm_s2 /= 10, machine.acceleration_z_mm_s2 /= 10;
  EXPECT_GT(plan_toolpath(s, board_200x100(), nullptr, machine).duration_s, 1.5 * path.duration_s);
}

TEST(Toolpath, SvgIsInMillimetersAndNotMirrored) {
  const TemporaryFolder folder;
  const Scratches s = some_scratches(50);
  const ToolpathReport report =
      write_toolpath(s, board_200x100(), nullptr, machine_profile("grbl"), {}, folder / "b.svg");
  const std::string text = file_text(folder / "b.svg");
  EXPECT_THAT(text, HasSubstr(R"(width="200mm" height="100mm" viewBox="0 0 200 100")"));
  std::vector<std::array<double, 4>> found;
  const std::regex line("<path d=\"M ([-.0-9]+) ([-.0-9]+) L ([-.0-9]+) ([-.0-9]+)\"/>");
  for (std::sregex_iterator it(text.begin(), text.end(), line), end; it != end; ++it)
    found.push_back({std::stod((*it)[1]), 100 - std::stod((*it)[2]), std::stod((*it)[3]), 100 - std::stod((*it)[4])});
  EXPECT_LT(worst_mm(s, report.order, found), 0.51e-4);
}

TEST(Toolpath, DxfIsR12InMillimetersWithYUp) {
  const TemporaryFolder folder;
  const Scratches s = some_scratches(50);
  const ToolpathReport report =
      write_toolpath(s, board_200x100(), nullptr, machine_profile("grbl"), {}, folder / "b.dxf");
  const std::string text = file_text(folder / "b.dxf");
  EXPECT_THAT(text, AllOf(HasSubstr("$ACADVER\n1\nAC1009\n"), HasSubstr("$INSUNITS\n70\n4\n")));
  EXPECT_TRUE(text.ends_with("0\nENDSEC\n0\nEOF\n"));
  // Group codes and values alternate; collect 10 20 11 21 of each LINE.
  std::istringstream stream(text);
  std::vector<std::array<double, 4>> found;
  bool in_line = false;
  for (std::string code, value; std::getline(stream, code) && std::getline(stream, value);) {
    if (code == "0") {
      in_line = value == "LINE";
      if (in_line) found.push_back({});
    } else if (in_line) {
      for (int c = 0; c < 4; ++c)
        if (code == std::array{"10", "20", "11", "21"}[c]) found.back()[c] = std::stod(value);
    }
  }
  EXPECT_LT(worst_mm(s, report.order, found), 0.51e-4);
}

// A drawing has no depths: they become layers. What else it cannot hold is refused.
TEST(Toolpath, DepthsOfADrawingAreItsLayers) {
  const TemporaryFolder folder;
  Scratches s = some_scratches(6);
  s.depth_um = {8, 12.5, 8, 8, 12.5, 20};
  const auto write = [&](const Scratches& scratches, const std::string& name, const ToolpathOptions& options) {
    return write_toolpath(scratches, board_200x100(), nullptr, machine_profile("grbl"), options, folder / name);
  };
  const ToolpathReport drawn = write(s, "b.svg", {});
  const std::string text = file_text(folder / "b.svg");
  EXPECT_EQ(count_of(text, "<g id=\"DEPTH_8_0_UM\""), 1u);
  EXPECT_LT(text.find("<g id=\"DEPTH_12_5_UM\""), text.find("<g id=\"DEPTH_20_0_UM\""));
  EXPECT_EQ(count_of(text.substr(0, text.find("DEPTH_12_5_UM")), "<path"), 3u);
  ASSERT_EQ(drawn.findings.size(), 1u);
  EXPECT_THAT(drawn.findings[0].what, HasSubstr("3 layers named by depth, DEPTH_8_0_UM to DEPTH_20_0_UM"));
  write(s, "b.dxf", {});
  EXPECT_EQ(count_of(file_text(folder / "b.dxf"), "LINE\n8\nDEPTH_12_5_UM\n"), 2u);
  EXPECT_THAT(file_text(folder / "b.dxf"), HasSubstr("LAYER\n2\nDEPTH_12_5_UM\n"));
  // Many depths share layers.
  Scratches many = some_scratches(500);
  for (std::size_t i = 0; i < many.size(); ++i) many.depth_um.push_back(8 + 0.02 * static_cast<double>(i));
  write(many, "m.svg", {});
  EXPECT_EQ(count_of(file_text(folder / "m.svg"), "<g id="), 11u);  // 8 to 18 um

  const auto refuse = [&](const ToolpathOptions& options, const char* what) {
    for (const char* name : {"no.svg", "no.dxf", "no.csv"})
      EXPECT_THAT([&] { write(s, name, options); }, ThrowsMessage<Error>(AllOf(HasSubstr(name), HasSubstr(what))));
  };
  ToolpathOptions options;
  options.frame = true;
  refuse(options, "--frame");
  options = {};
  options.part_s = 60;
  refuse(options, "--chunks");
  options = {};
  options.heights = HeightMap{};
  refuse(options, "--heights");
  options = {};
  options.follow_bow = true;
  refuse(options, "--follow-bow");
}

TEST(Toolpath, AMachineWithAKnownFaultCarvesTheDesign) {
  Affine2 fault;
  fault << 1.004, 0.003, -0.4, -0.002, 0.997, 0.6;
  const Scratches s = some_scratches(200);
  const Bench bench = bench_with_machine(fault);
  const MachineProfile machine = machine_profile("grbl");
  const Toolpath path = plan_toolpath(s, board_200x100(), &bench, machine);
  EXPECT_TRUE(path.compensated);
  const Replay replay = replay_gcode(gcode_parts(path, machine)[0].text, machine, "x");
  std::vector<std::array<double, 4>> carved;  // what the faulty machine makes of the file
  for (const ReplayedScratch& r : replay.scratches) {
    const Eigen::Vector2d p0 = fault * r.from_mm.homogeneous(), p1 = fault * r.to_mm.homogeneous();
    carved.push_back({p0.x(), p0.y(), p1.x(), p1.y()});
  }
  EXPECT_LT(worst_mm(s, path.order, carved), 0.6e-4);  // the file's rounding through the map
  EXPECT_FALSE(plan_toolpath(s, board_200x100(), nullptr, machine).compensated);
  const Bench nominal;
  EXPECT_FALSE(plan_toolpath(s, board_200x100(), &nominal, machine).compensated);
}

TEST(Toolpath, DepthsAreCommandsNotMeasurements) {
  Scratches s = some_scratches(2);
  const Board board = board_200x100();  // the machine was told 14 um
  Bench bench;
  bench.material.depth_um = 28;  // and made 28 of it
  const MachineProfile machine = machine_profile("grbl");
  const auto depths = [&] {
    const Toolpath path = plan_toolpath(s, board, &bench, machine, {.keep_order = true});
    return std::pair(path.scratches[0].depth_mm, path.scratches[1].depth_mm);
  };
  EXPECT_EQ(depths(), std::pair(0.014, 0.014));
  s.depth_um = {20, 30};  // depths to be reached: half of each must be told, once that is measured
  EXPECT_EQ(depths(), std::pair(0.020, 0.030));
  bench.material_sigma.depth_um = 0.5;
  EXPECT_EQ(depths(), std::pair(0.010, 0.015));
  bench.verdict[parameter::kDepth].degree = Degree::not_determined;
  EXPECT_EQ(depths(), std::pair(0.020, 0.030));
}

TEST(Toolpath, PartsStartOnTheirOwnAndTogetherCarveAll) {
  const TemporaryFolder folder;
  const Scratches s = some_scratches(900);
  MachineProfile machine = machine_profile("grbl");
  const auto write = [&](const ToolpathOptions& options) {
    return write_toolpath(s, board_200x100(), nullptr, machine, options, folder / "board.gcode");
  };
  const ToolpathReport whole = write({});
  EXPECT_EQ(whole.files.size(), 1u);
  EXPECT_EQ(folder.file_count(), 1u);

  ToolpathOptions options;
  options.part_s = 120;
  options.frame = true;
  const ToolpathReport report = write(options);
  ASSERT_GT(report.files.size(), 4u);
  EXPECT_EQ(report.files[0], folder / "board-01.gcode");
  EXPECT_EQ(report.files.back(), folder / "board-frame.gcode");
  EXPECT_EQ(folder.file_count(), report.files.size());  // the whole job's file is gone: nobody may carve it twice
  std::vector<ReplayedScratch> carved;
  for (std::size_t k = 0; k + 1 < report.files.size(); ++k) {
    const Replay part = replay_gcode(file_text(report.files[k]), machine, "part");  // replay starts knowing nothing
    EXPECT_LT(part.duration_s, 125) << k;
    EXPECT_NEAR(part.duration_s, report.file_duration_s[k], 1e-9);
    carved.insert(carved.end(), part.scratches.begin(), part.scratches.end());
  }
  const Toolpath path = plan_toolpath(s, board_200x100(), nullptr, machine);
  EXPECT_TRUE(check_toolpath(carved, path.scratches, 1e-3).good());
  const Replay frame = replay_gcode(file_text(report.files.back()), machine, "frame");
  EXPECT_TRUE(frame.scratches.empty());
  EXPECT_NEAR(frame.max_mm.x(), path.max_mm.x(), 1e-4);
  EXPECT_EQ(frame.min_mm.z(), machine.safe_z_mm);

  machine.max_lines = 1000;
  const ToolpathReport by_lines = write({});
  EXPECT_GT(by_lines.files.size(), 3u);
  EXPECT_EQ(folder.file_count(), by_lines.files.size() + 1);  // and the frame
  for (const auto& file : by_lines.files) EXPECT_LE(count_of(file_text(file), "\n"), 1000u);
}

TEST(Toolpath, OtherPeoplesFilesStay) {
  const TemporaryFolder folder;
  folder.write("board-07.gcode", "G21 G90\n");  // not ours: no first line that says so
  folder.write("board-old.gcode", "(Burin tool path)\n");
  write_toolpath(some_scratches(5), board_200x100(), nullptr, machine_profile("grbl"), {}, folder / "board.gcode");
  EXPECT_EQ(folder.file_count(), 3u);
}

// Another job's files may have names like parts'; only what a head names as a part of this one goes, and is named.
TEST(Toolpath, OtherJobsFilesStay) {
  const TemporaryFolder folder;
  const MachineProfile machine = machine_profile("grbl");
  const auto write = [&](std::size_t count, const char* out, double part_s = 0) {
    ToolpathOptions options;
    options.part_s = part_s;
    return write_toolpath(some_scratches(count), board_200x100(), nullptr, machine, options, folder / out);
  };
  for (const char* other : {"job-1.gcode", "job-2.gcode", "job-2026.gcode", "job-07.gcode"}) write(3, other);
  const auto names = [](const std::vector<std::filesystem::path>& files) {
    std::vector<std::string> out;
    for (const auto& file : files) out.push_back(file.filename().string());
    return out;
  };
  EXPECT_TRUE(write(5, "job.gcode").removed.empty());
  EXPECT_EQ(folder.file_count(), 5u);
  // In parts: the whole goes. A part never takes another job's place.
  const ToolpathReport parts = write(100, "job.gcode", 30);
  const std::size_t count = parts.files.size();
  ASSERT_GT(count, 2u);
  ASSERT_LT(count, 7u);
  EXPECT_EQ(names(parts.removed), std::vector<std::string>{"job.gcode"});
  EXPECT_THAT([&] { write(400, "job.gcode", 30); },
              ThrowsMessage<Error>(AllOf(HasSubstr("job-07.gcode"), HasSubstr("no part of an earlier job.gcode"))));
  EXPECT_EQ(folder.file_count(), 4 + count);
  const ToolpathReport whole = write(5, "job.gcode");
  EXPECT_EQ(names(whole.removed), names(parts.files));
  EXPECT_EQ(folder.file_count(), 5u);
}

// A header of the machine's own comes first, and tells the whole file.
TEST(Toolpath, AProfilesHeadTellsTheWholeFile) {
  const TemporaryFolder folder;
  const auto profile = folder.write("snap.json", R"({"format": "burin/machine", "version": 1, "based_on": "marlin",
      "head": [";Header Start", ";header_type: cnc", ";file_total_lines: {lines}", ";estimated_time(s): {time_s}",
               ";max_x(mm): {max_x}", ";min_z(mm): {min_z}", ";part {part} of {parts}, {scratches}",
               ";work_speed(mm/minute): {feed}", ";Header End"]})");
  ToolpathOptions options;
  options.part_s = 60;
  options.frame = true;
  const ToolpathReport report = write_toolpath(some_scratches(60), board_200x100(), nullptr,
                                               read_machine_profile(profile), options, folder / "b.gcode");
  ASSERT_GE(report.files.size(), 3u);
  for (std::size_t k = 0; k < report.files.size(); ++k) {
    const std::string text = file_text(report.files[k]);
    const Replay replay = replay_gcode(text, read_machine_profile(profile), "b");
    EXPECT_TRUE(text.starts_with(";Header Start\n;header_type: cnc\n"));
    EXPECT_THAT(text, HasSubstr(";file_total_lines: " + std::to_string(count_of(text, "\n")) + "\n"));
    EXPECT_THAT(
        text,
        HasSubstr(";estimated_time(s): " + std::to_string(static_cast<int>(std::ceil(replay.duration_s))) + "\n"));
    double max_x = 0;
    std::sscanf(text.c_str() + text.find(";max_x"), ";max_x(mm): %lf", &max_x);
    EXPECT_NEAR(max_x, replay.max_mm.x(), 1e-4);
    EXPECT_THAT(text, HasSubstr(k + 1 < report.files.size() ? ";min_z(mm): -0.0140\n" : ";min_z(mm): 1.0000\n"));
    EXPECT_THAT(text, HasSubstr(";work_speed(mm/minute): 1200\n;Header End\n; Burin "));
  }
  // Parts are known as such behind that head, too.
  EXPECT_EQ(
      write_toolpath(some_scratches(3), board_200x100(), nullptr, read_machine_profile(profile), {}, folder / "b.gcode")
          .removed.size(),
      report.files.size() - 1);
  MachineProfile wrong = machine_profile("grbl");
  wrong.start.emplace_back("(of {lines})");
  EXPECT_THAT([&] { write_toolpath(some_scratches(3), board_200x100(), nullptr, wrong, {}, folder / "c.gcode"); },
              ThrowsMessage<Error>(AllOf(HasSubstr("{lines}"), HasSubstr("in head, lines, time_s"))));
}

TEST(Toolpath, FilesThatAreToBeShorterThanAScratchAreRefused) {
  const TemporaryFolder folder;
  MachineProfile machine = machine_profile("grbl");
  machine.max_lines = 5;
  EXPECT_THAT([&] { write_toolpath(some_scratches(3), board_200x100(), nullptr, machine, {}, folder / "b.gcode"); },
              ThrowsMessage<Error>(AllOf(HasSubstr("at most 5 lines leave no room"), HasSubstr("--max-lines"))));
  EXPECT_EQ(folder.file_count(), 0u);
}

TEST(Toolpath, WhatCannotBeCarvedIsNamed) {
  const TemporaryFolder folder;
  MachineProfile machine = machine_profile("grbl");
  const auto expect = [&](const Scratches& s, const Bench* bench, const char* out, const auto& message) {
    EXPECT_THAT([&] { write_toolpath(s, board_200x100(), bench, machine, {}, folder / out); },
                ThrowsMessage<Error>(message));
    EXPECT_EQ(folder.file_count(), 0u);
  };
  Scratches s = some_scratches(3);
  expect(s, nullptr, "board.stl", AllOf(HasSubstr(".stl"), HasSubstr(".gcode")));
  expect(s, nullptr, "no/board.gcode", HasSubstr("no folder"));
  expect({}, nullptr, "board.gcode", HasSubstr("no scratch to carve"));
  s.x1_mm[1] = 195;
  expect(s, nullptr, "board.gcode", AllOf(HasSubstr("row 2"), HasSubstr("carve area"), HasSubstr("195.000")));
  s.x1_mm[1] = std::nan("");
  expect(s, nullptr, "board.gcode", AllOf(HasSubstr("row 2"), HasSubstr("not a number")));

  s = some_scratches(3);
  machine.travel = MachineBounds{{0, 0}, {200, 100}};
  Affine2 shift;
  shift << 1, 0, 60, 0, 1, 0;  // carves 60 mm too far right: some ends would have to be left of the machine's zero
  const Bench bench = bench_with_machine(shift);
  s.x0_mm = {90, 80, 30}, s.x1_mm = {91, 81, 31};
  expect(s, &bench, "board.gcode",
         AllOf(HasSubstr("row 3"), HasSubstr("compensated"), HasSubstr("travel of grbl"), HasSubstr("-30.000")));

  machine = machine_profile("grbl");
  machine.per_scratch = {"G0 X{x0} Y{y0}", "G1 Z{zcarve} F100"};
  expect(some_scratches(3), nullptr, "board.gcode", AllOf(HasSubstr("{zcarve}"), HasSubstr("z_carve")));
  machine.per_scratch = {"G0 X{x0} Y{y0}", "G1 Z{z_carve} F100", "G0 Z{z_safe}"};  // forgets to carve
  expect(some_scratches(3), nullptr, "board.gcode", HasSubstr("carves nothing: a hole"));
  machine.per_scratch = {"G0 X{x0} Y{y0}"};
  expect(some_scratches(3), nullptr, "board.gcode", HasSubstr("3 scratches lost"));
  machine.per_scratch = {"G0 X{x0} Y{y0}", "G1 Z{z_carve} F100", "G0 X{x1} Y{y1}", "G0 Z{z_safe}"};
  expect(some_scratches(3), nullptr, "board.gcode", HasSubstr("G0 through the metal"));
}

TEST(Toolpath, AHeadThatPressesInsteadOfPlunging) {
  MachineProfile machine = machine_profile("grbl");
  machine.per_scratch = {"G0 X{x0} Y{y0}", "M3 S{depth_um}", "G4 P{dwell_s}", "G1 X{x1} Y{y1} F{feed}", "M5"};
  const Toolpath path = plan_toolpath(some_scratches(10), board_200x100(), nullptr, machine);
  const Replay replay = replay_gcode(gcode_parts(path, machine)[0].text, machine, "x");
  EXPECT_TRUE(std::isnan(replay.scratches.at(0).depth_mm));  // the file does not tell
  EXPECT_TRUE(check_toolpath(replay.scratches, path.scratches, 1e-3).good());
}

TEST(Toolpath, WhatAnInterruptedFileLeftIsCarvedOnce) {
  const TemporaryFolder folder;
  const Scratches s = some_scratches(60);
  Bench bench = bench_with_machine((Affine2() << 1.001, 0.002, 0.3, -0.001, 0.999, -0.2).finished());
  std::mt19937 random(3);
  for (const char* name : {"grbl", "marlin"}) {
    const MachineProfile machine = machine_profile(name);
    ToolpathOptions options;
    options.part_s = 30;
    const auto out = folder / (std::string(name) + ".gcode");
    const ToolpathReport whole = write_toolpath(s, board_200x100(), &bench, machine, options, out);
    ASSERT_GE(whole.files.size(), 3u);
    const std::filesystem::path stopped = whole.files[1];
    const Replay file = replay_gcode(file_text(stopped), machine, "stopped");
    ToolpathOptions keep;
    keep.keep_order = true;
    const Toolpath planned = plan_toolpath(s, board_200x100(), &bench, machine, keep);
    for (int k = 0; k < 20; ++k) {
      const std::size_t line =
          file.scratches[0].line + 1 + random() % (file.scratches.back().line - file.scratches[0].line);
      options.part_s = 0;
      options.frame = true;
      options.after = Interruption{stopped, line};
      const auto rest_file = folder / "rest.gcode";
      const ToolpathReport rest = write_toolpath(s, board_200x100(), &bench, machine, options, rest_file);
      ASSERT_EQ(rest.files.front(), rest_file);
      // What a machine carves that stops before `line`, then does the rest, then the other parts: everything once.
      std::vector<ReplayedScratch> carved;
      for (const ReplayedScratch& done : file.scratches)
        if (done.line < line) carved.push_back(done);
      EXPECT_EQ(rest.done_before, carved.size());
      const Replay left = replay_gcode(file_text(rest_file), machine, "rest");
      // Each as it would have been carved: same order, same direction, same digits.
      ASSERT_EQ(carved.size() + left.scratches.size(), file.scratches.size());
      for (std::size_t i = 0; i < left.scratches.size(); ++i) {
        EXPECT_EQ(left.scratches[i].from_mm, file.scratches[carved.size() + i].from_mm);
        EXPECT_EQ(left.scratches[i].to_mm, file.scratches[carved.size() + i].to_mm);
        EXPECT_EQ(left.scratches[i].depth_mm, file.scratches[carved.size() + i].depth_mm);
      }
      carved.insert(carved.end(), left.scratches.begin(), left.scratches.end());
      for (std::size_t f = 0; f < whole.files.size(); ++f) {
        if (f == 1) continue;
        const Replay part = replay_gcode(file_text(whole.files[f]), machine, "part");
        carved.insert(carved.end(), part.scratches.begin(), part.scratches.end());
      }
      EXPECT_TRUE(check_toolpath(carved, planned.scratches, 1e-3).good());
      // It lifts the tool before anything else moves, wherever it was left.
      const std::string text = file_text(rest_file);
      EXPECT_LT(text.find("\nG0 Z"), text.find("\nG0 X")) << text.substr(0, 300);
    }
    for (const auto& part : whole.files) EXPECT_TRUE(std::filesystem::exists(part)) << part;
  }
}

TEST(Toolpath, InterruptionsThatLeaveNothingToDoAreRefused) {
  const TemporaryFolder folder;
  const Scratches s = some_scratches(20);
  const MachineProfile machine = machine_profile("grbl");
  const auto file = folder / "board.gcode";
  write_toolpath(s, board_200x100(), nullptr, machine, {}, file);
  const Replay replay = replay_gcode(file_text(file), machine, "board");
  const auto expect = [&](const Scratches& scratches, std::size_t line, const std::string& out, const char* message) {
    ToolpathOptions options;
    options.after = Interruption{file, line};
    EXPECT_THAT([&] { write_toolpath(scratches, board_200x100(), nullptr, machine, options, folder / out); },
                ThrowsMessage<Error>(HasSubstr(message)));
  };
  expect(s, 3, "rest.gcode", "carved nothing before line 3");
  expect(s, replay.scratches.back().line + 1, "rest.gcode", "carved all its scratches");
  expect(s, replay.lines + 1, "rest.gcode", "is not in the file");
  expect(s, 40, "board.gcode", "is the file that was interrupted");
  Scratches others = s;
  others.x0_mm[7] += 0.5;
  expect(others, 40, "rest.gcode", "carves a scratch that is not among those given");
  // Another depth, also one that is less than a micrometer off.
  others = s;
  others.depth_um.assign(s.size(), 14.2);
  expect(others, 40, "rest.gcode", "carves a scratch that is not among those given");
  EXPECT_FALSE(std::filesystem::exists(folder / "rest.gcode"));
}

// A file that lost its end, and scratches with it, is none to go on from.
TEST(Toolpath, AnInterruptedFileThatWasCutOffIsRefused) {
  const TemporaryFolder folder;
  const Scratches s = some_scratches(20);
  for (const char* name : {"grbl", "marlin", "linuxcnc"}) {
    const MachineProfile machine = machine_profile(name);
    const auto file = folder / "board.gcode";
    write_toolpath(s, board_200x100(), nullptr, machine, {}, file);
    const std::string text = file_text(file);
    const std::size_t line = replay_gcode(text, machine, "b").scratches[4].line;
    std::size_t cuts = 0;
    for (std::size_t at = text.find("\nG0 X"); at != std::string::npos; at = text.find("\nG0 X", at + 1)) {
      folder.write("cut.gcode", text.substr(0, at + 1));
      ToolpathOptions options;
      options.after = Interruption{folder / "cut.gcode", line};
      EXPECT_THAT([&] { write_toolpath(s, board_200x100(), nullptr, machine, options, folder / "rest.gcode"); },
                  ThrowsMessage<Error>(HasSubstr("cut off")))
          << name << " " << at;
      ++cuts;
    }
    EXPECT_EQ(cuts, 20u);
    EXPECT_FALSE(std::filesystem::exists(folder / "rest.gcode"));
  }
}

TEST(Toolpath, KeepsTheOrderWhereTheBenchSaysThatItShows) {
  const Board board = board_200x100();
  const Scratches s = some_scratches(200);
  const MachineProfile machine = machine_profile("grbl");
  const auto kept = [&](const Bench& bench, std::optional<bool> keep = {}) {
    ToolpathOptions options;
    options.keep_order = keep;
    const Toolpath path = plan_toolpath(s, board, &bench, machine, options);
    bool as_given = true;
    for (std::size_t i = 0; i < s.size(); ++i) as_given &= path.order[i].scratch == i && !path.order[i].reversed;
    EXPECT_EQ(path.kept_order, as_given);
    return as_given;
  };
  Bench bench;
  bench.material = board.material;
  EXPECT_FALSE(kept(bench));
  bench.depth_field.terms[0] = 0.1;  // over the board: the order does not show
  EXPECT_FALSE(kept(bench));
  bench.depth_field.terms[5] = 0.04;
  EXPECT_TRUE(kept(bench));
  EXPECT_FALSE(kept(bench, false));
  bench.depth_field.terms[5] = 0;
  bench.crossings = Crossings::last;
  EXPECT_TRUE(kept(bench));
  bench.crossings = Crossings::add;
  EXPECT_TRUE(kept(bench, true));
}

TEST(Toolpath, WhatIsSentKeepsItsColumnsInCarvingOrder) {
  const TemporaryFolder folder;
  const Board board = board_200x100();
  Scratches s = some_scratches(30);
  for (std::size_t i = 0; i < s.size(); ++i) {
    s.depth_um.push_back(10 + 0.1 * static_cast<double>(i));
    s.alpha.push_back(0.03 + 0.001 * static_cast<double>(i));
    s.carved.push_back(i % 5 == 0 ? 1 : 0);
  }
  Bench bench;
  bench.material = board.material;
  bench.material.depth_um = 2 * board.material.depth_um;
  bench.material.alpha = 0.5 * board.material.alpha;
  bench.material_sigma.depth_um = 0.1;
  bench.machine_affine << 1.002, 0, 0.1, 0, 0.999, -0.2;
  const ToolpathReport report = write_toolpath(s, board, &bench, machine_profile("grbl"), {}, folder / "sent.csv");
  const Scratches sent = read_scratches(folder / "sent.csv");
  ASSERT_EQ(sent.size(), 24U);
  EXPECT_TRUE(sent.carved.empty());
  ASSERT_EQ(report.order.size(), sent.size());
  for (std::size_t k = 0; k < sent.size(); ++k) {
    const std::size_t i = report.order[k].scratch;
    EXPECT_NEAR(sent.depth_um[k], s.depth_um[i] / 2, 1e-6);
    EXPECT_NEAR(sent.alpha[k], 2 * s.alpha[i], 1e-6);
    EXPECT_NEAR(1.002 * sent.x0_mm[k] + 0.1, (report.order[k].reversed ? s.x1_mm : s.x0_mm)[i], 2e-5);
    EXPECT_NEAR(0.999 * sent.y1_mm[k] - 0.2, (report.order[k].reversed ? s.y0_mm : s.y1_mm)[i], 2e-5);
  }
}

}  // namespace
}  // namespace burin
