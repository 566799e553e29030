// Proves: no word from outside reaches G-code but made safe, what lies on the disk is what was replayed, and of
// thousands of changed files and profiles the replay accepts none that a second, stricter reader would carve otherwise.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "burin/base/error.h"
#include "burin/base/files/json_file.h"
#include "burin/optimize/toolpath.h"
#include "burin/optimize/toolpath/gcode_line.h"
#include "tests/optimize/carving_bench.h"
#include "tests/reliability/gcode_fuzz.h"
#include "tests/reliability/strict_gcode.h"
#include "tests/temporary_folder.h"

namespace burin {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::ThrowsMessage;

TEST(CommentWord, KeepsLettersDigitsBlankAndLittleElse) {
  EXPECT_EQ(comment_word("my router-2_a.b"), "my router-2_a.b");
  EXPECT_EQ(comment_word("my router (left)\nG1 Z-5"), "my router _left__G1 Z-5");
  EXPECT_EQ(comment_word("caf\xc3\xa9 !?~%;"), "caf__ _____");
  EXPECT_EQ(comment_word(std::string(300, 'x')), std::string(40, 'x'));
}

TEST(CommentLines, HoldNothingThatAControllerOrASenderActsOn) {
  const MachineProfile grbl = machine_profile("grbl"), marlin = machine_profile("marlin");
  EXPECT_EQ(comment_lines(grbl, "scratches 1 to 4 of 4, X10.5"), "(scratches 1 to 4 of 4, X10.5)\n");
  EXPECT_EQ(comment_lines(marlin, "M30 mini; T1, G28 and M 6"), "; M_30 mini, T_1, G_28 and M_6\n");
  EXPECT_EQ(comment_lines(grbl, "CAM30 msg $32=1 (a) !?~%"), "(CAM_30 ms_g _32_1 _a_ ____)\n");
  for (const int width : {0, 40, 60, 300}) {
    MachineProfile machine = grbl;
    machine.max_line_characters = width;
    const std::string text = comment_lines(machine, "part 12 of 120, scratches 1000001 to 2000000 of 3000000 " +
                                                        std::string(90, 'x') + " (LOGOPEN, a) MSG, b");
    std::size_t most = 0;
    for (std::size_t at = 0; at < text.size();) {
      const std::size_t end = text.find('\n', at);
      most = std::max(most, end - at);
      EXPECT_TRUE(at == 0 || text.compare(at, 2, "(-") == 0) << text;  // no line begins with an active word
      EXPECT_EQ(text[end - 1], ')');
      at = end + 1;
    }
    EXPECT_LE(most, width == 40 ? 40u : width == 60 ? 60u : 70u);
    const auto head = read_gcode_head(comment_lines(machine, "Burin tool path for x") + text);
    ASSERT_TRUE(head.has_value()) << text;
    EXPECT_EQ(head->part, 12u);
    EXPECT_EQ(head->of, 3000000u);
  }
  EXPECT_FALSE(read_gcode_head("(Burin frame for x)\n(part 1 of 1, scratches 1 to 4 of 4)\n").has_value());
}

// Whatever a machine is called and whatever its file needs to tell, each of its lines fits a short buffer.
TEST(GcodeSafety, CommentsOfAllFilesAreShortAndMeanNothing) {
  const TemporaryFolder folder;
  const Scratches scratches = read_scratches(folder.write("s.csv", "x0_mm,y0_mm,x1_mm,y1_mm\n30,30,34,33\n"));
  for (const char* name : {"grbl", "grbl-spring", "linuxcnc", "marlin", "laser-z"}) {
    MachineProfile machine = machine_profile(name);
    machine.name = "M30 mini T1 MSG S5 G28 M6";
    machine.max_line_characters = 40;
    ToolpathOptions options;
    options.frame = true;
    Board board;
    board.size_mm = {100, 100};
    board.carve_max_mm = {100, 100};
    board.material.depth_um = 10;
    for (const auto& file : write_toolpath(scratches, board, nullptr, machine, options, folder / "b.gcode").files) {
      const std::string text = read_text(file);
      for (std::size_t at = 0; at < text.size();) {
        const std::string line = text.substr(at, text.find('\n', at) - at);
        at += line.size() + 1;
        EXPECT_LE(line.size(), 40u);
        if (line[0] != '(' && line[0] != ';') continue;
        EXPECT_THAT(line.substr(1), Not(::testing::ContainsRegex("[GMTgmt][0-9]|MSG|[$!?~%;=]"))) << line;
      }
    }
  }
}

// LinuxCNC takes a % for the beginning of a file on its first line alone; further down it is a character like others.
TEST(GcodeSafety, LinuxcncsPercentStaysBeforeLinesOfOurs) {
  const TemporaryFolder folder;
  const Scratches scratches = read_scratches(folder.write("s.csv", "x0_mm,y0_mm,x1_mm,y1_mm\n30,30,34,33\n"));
  MachineProfile machine = machine_profile("linuxcnc");
  machine.start.insert(machine.start.begin(), "%");
  machine.end = {"G0 Z{z_safe}", "%"};
  Board board;
  board.size_mm = board.carve_max_mm = {100, 100};
  board.material.depth_um = 10;
  ToolpathOptions options;
  options.frame = true;
  for (const char* name : {"b.ngc", "b.cnc", "b.TAP"}) {
    const auto report = write_toolpath(scratches, board, nullptr, machine, options, folder / name);
    ASSERT_EQ(report.files.size(), 2u);
    for (const auto& file : report.files) {
      const std::string text = read_text(file);
      EXPECT_EQ(text.rfind("%\n(Burin", 0), 0u) << text;
      EXPECT_THAT(text, HasSubstr(")\nG61\nG21 G90"));
    }
  }
}

TEST(GcodeSafety, AMachinesNameMovesNothing) {
  const TemporaryFolder folder;
  MachineProfile machine = machine_profile("grbl");
  const Scratches scratches = read_scratches(folder.write("s.csv", "x0_mm,y0_mm,x1_mm,y1_mm\n30,30,34,33\n"));
  Board board;
  board.size_mm = {100, 100};
  board.carve_min_mm = {10, 10};
  board.carve_max_mm = {90, 90};
  board.material.depth_um = 10;
  for (const char* name : {"a\nG0 X5\nG1 Z-9 F100", "my router (left)", ")G1 Z-9 F9(", "\xe4\xb8\xad", "!"}) {
    machine.name = name;
    ToolpathOptions options;
    options.frame = true;
    const ToolpathReport report = write_toolpath(scratches, board, nullptr, machine, options, folder / "board.gcode");
    ASSERT_EQ(report.replayed.size(), 1u);
    for (const auto& file : report.files) {
      const std::string text = read_text(file);
      EXPECT_THAT(text, Not(HasSubstr("\nG1 Z-9")));
      EXPECT_TRUE(text.starts_with("(Burin "));
      EXPECT_THAT(text.substr(0, text.find('\n')), ::testing::MatchesRegex("[(][a-zA-Z0-9 _.,-]*[)]"));
      EXPECT_EQ(text.find_first_not_of("\nABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789 .,:;_-()"),
                std::string::npos)
          << text;
      EXPECT_EQ(strict::execute(text, {}).alarm, "");
    }
  }
  // What a profile's numbers and lines would do wrong is found before a file is there.
  machine.name = "grbl";
  const std::string before = read_text(folder / "board.gcode");
  const Scratches three =
      read_scratches(folder.write("s.csv", "x0_mm,y0_mm,x1_mm,y1_mm\n30,30,34,33\n40,30,44,33\n50,30,54,33\n"));
  const auto refused = [&](const std::string& why) {
    EXPECT_THAT([&] { write_toolpath(three, board, nullptr, machine, {}, folder / "board.gcode"); },
                ThrowsMessage<Error>(HasSubstr(why)));
    EXPECT_EQ(read_text(folder / "board.gcode"), before);
  };
  machine.carve_feed_mm_min = 1e-300;
  refused("a feed of 0 mm/min");
  machine.carve_feed_mm_min = 1200;
  machine.safe_z_mm = 1e-9;
  refused("travels on the face");
  machine.safe_z_mm = 1;
  machine.end = {"G0 Z1", "M2", "G0 X0 Y0"};
  refused("goes on after its end");
}

TEST(GcodeSafety, WhatIsOnTheDiskIsWhatIsReplayed) {
  const TemporaryFolder folder;
  const MachineProfile machine = machine_profile("grbl");
  const std::string text = "G21 G90\nG0 Z1\nM2\n";
  EXPECT_NO_THROW(replay_written(folder.write("a.gcode", text), text, {}, machine, "a.gcode"));
  for (const std::string& other : {std::string("G21 G90\nG0 Z2\nM2\n"), text.substr(0, 9), std::string()})
    EXPECT_THAT([&] { replay_written(folder.write("a.gcode", other), text, {}, machine, "a.gcode"); },
                ThrowsMessage<Error>(HasSubstr("not on the disk as it was written")));
}

TEST(GcodeSafety, ProfilesWithNumbersThatNoMachineHasAreRefused) {
  const TemporaryFolder folder;
  const auto refuses = [&](const std::string& keys, const std::string& field) {
    const auto file = folder.write("m.json", "{\"format\":\"burin/machine\",\"version\":1," + keys + "}");
    EXPECT_THAT([&] { read_machine_profile(file); }, ThrowsMessage<Error>(HasSubstr(field))) << keys;
  };
  refuses("\"carve_feed_mm_min\":1e-300", "carve_feed_mm_min");
  refuses("\"carve_feed_mm_min\":1e100", "carve_feed_mm_min");
  refuses("\"plunge_feed_mm_min\":-3", "plunge_feed_mm_min");
  refuses("\"safe_z_mm\":1e-9", "safe_z_mm");
  refuses("\"dwell_s\":1e9", "dwell_s");
  refuses("\"force\":1e300", "force");
  refuses("\"travel_mm\":[[0,0],[400,1e308]]", "travel_mm");
  refuses("\"max_line_characters\":7", "max_line_characters");
  refuses("\"other_m_codes\":[30]", "other_m_codes");
  refuses("\"other_m_codes\":\"M42\"", "other_m_codes");
  refuses("\"start\":[\"G21\\rG1 Z-5\"]", "start");
  refuses("\"end\":[\"M2 \\u00e9\"]", "end");
}

// The judge is worth something: it stops at what would spoil a board, and measures where it does not.
TEST(GcodeSafety, TheStrictReaderIsStrict) {
  const std::string head = "G21 G90\nG0 Z1\nG0 X1 Y1\n";
  for (const char* line :
       {"G1 X2 F0",     "G1 X3e10 F9", "G20",   "G91",   "G2 X5 I1",    "M98",    "G0 Z-1", "G1 Z-1 F9\nG0 Z1",
        "G1 X5 Z-1 F9", "G0 Z0\nX5",   "(!)",   "(a",    "$J=G91 X5",   "%",      "G55",    "M2\nG0 X5",
        "G1 Z-1 F9",    "G28 Z0",      "G4 X5", "X1 X2", "G0 G1 X5 F9", "M3 S100"})
    EXPECT_NE(strict::execute(head + line + "\n", {}).alarm, "") << line;
  const strict::Executed done = strict::execute(head + "G1 Z-0.0125 F9\nX2.5 Y-3\nG0 Z1\nM2\n", {});
  EXPECT_EQ(done.alarm, "");
  ASSERT_EQ(done.strokes.size(), 1u);
  EXPECT_EQ(done.strokes[0].x0, 1000000);
  EXPECT_EQ(done.strokes[0].x1, 2500000);
  EXPECT_EQ(done.strokes[0].y1, -3000000);
  EXPECT_EQ(done.strokes[0].z, 12500);
}

TEST(GcodeSafety, TheStrictReaderKnowsWhatASheetIs) {
  strict::Sheet sheet;
  sheet.width = 60, sheet.height = 50, sheet.deepest = 0.1;
  sheet.standing = {{{{20, 10}, {25, 10}, {25, 40}, {20, 40}}, 0, 0, 0, 8}, {{}, 40, 25, 3, 0}};
  strict::Controller controller;
  controller.sheet = &sheet;
  const auto alarm = [&](const std::string& lines) {
    return strict::execute("G21 G90\n" + lines + "G0 Z9\nM2\n", controller).alarm;
  };
  const std::string there = "G0 Z9\nG0 X10 Y25\n";
  EXPECT_EQ(alarm(there + "G1 Z-0.05 F99\nX15\nG0 Z9\nG0 X45 Y30\n"), "");
  EXPECT_EQ(alarm("G0 Z1\nG0 X10 Y25\n"), "a first way too low");
  EXPECT_EQ(alarm(there + "G0 X70\n"), "off the sheet");
  EXPECT_EQ(alarm(there + "G1 Z-0.2 F99\nX15\n"), "deeper than the tip");
  EXPECT_EQ(alarm(there + "G0 Z1\nG0 X30\n"), "through what stands there");
  EXPECT_EQ(alarm(there + "G0 X36\nG1 Z-0.05 F99\nX44\n"), "carves what stands there");
  sheet.face = [](double x, double) { return x < 32 ? 0.0 : 2.0; };
  sheet.face_top = 2;
  EXPECT_EQ(alarm("G0 Z11\nG0 X45 Y5\nG1 Z1.5 F99\nX46\n"), "deeper than the tip");
  sheet.face = {};
  EXPECT_EQ(strict::words_off_sheet("(X999)\nG0 X10 Y-2\nG1 Z-0.05\nG53 G0 X-400 Z0\n", sheet), "");
  for (const char* line : {"G0 X66", "G1 Y-5.1", "G1 Z-0.2", "G0 Z151", "G53 G0 Z-3"})
    EXPECT_NE(strict::words_off_sheet(line, sheet), "") << line;
}

// The short form of tests/reliability/gcode_fuzz_main.cpp.
TEST(GcodeSafety, ChangedFilesAreReadAsStrictlyAsAControllerReads) {
  const GcodeFuzz fuzz = fuzz_gcode(20260101, 40000, 20);
  EXPECT_GT(fuzz.accepted, fuzz.runs / 50) << "too few good ones to say anything";
  EXPECT_GT(fuzz.released, fuzz.runs / 100);
  for (const std::string& finding : fuzz.findings) ADD_FAILURE() << finding;
}

TEST(GcodeSafety, ChangedProfilesWriteNothingThatIsUnsafe) {
  const TemporaryFolder folder;
  const GcodeFuzz fuzz = fuzz_profiles(20260102, 5000, 10, folder.path());
  EXPECT_GT(fuzz.accepted, fuzz.runs / 50) << "too few good ones to say anything";
  for (const std::string& finding : fuzz.findings) ADD_FAILURE() << finding;
}

TEST(GcodeSafety, FilesWithAChangedNumberWriteNothingThatIsUnsafe) {
  const TemporaryFolder folder;
  const GcodeFuzz fuzz = fuzz_inputs(20260103, 3000, 10, folder.path());
  EXPECT_GT(fuzz.accepted, fuzz.runs / 10) << "too few good ones to say anything";
  for (const std::string& finding : fuzz.findings) ADD_FAILURE() << finding;
}

}  // namespace
}  // namespace burin
