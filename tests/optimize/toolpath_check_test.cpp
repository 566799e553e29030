// Proves: the replay reads G-code as a controller does, finds each fault that would spoil a board, and names the line.
#include "burin/optimize/toolpath/toolpath_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "burin/base/error.h"

namespace burin {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

Replay replay(const std::string& text, const char* machine = "grbl") {
  return replay_gcode(text, machine_profile(machine), "file.nc");
}

constexpr const char* kHead = "G21 G90\nG0 Z1\n";

TEST(Replay, WordsInAnyCaseAndSpacingAreRead) {
  const Replay r = replay(
      "%\n(a comment G91)\nN10 g21g90g61 ; another\nG0Z1\nG00 X10 Y 20.5\ng1 z-.01 f 300\nX+13Y24.5F600\nG0 Z1\r\n"
      "M2\n",
      "linuxcnc");
  ASSERT_EQ(r.scratches.size(), 1u);
  EXPECT_EQ(r.scratches[0].from_mm, Eigen::Vector2d(10, 20.5));
  EXPECT_EQ(r.scratches[0].to_mm, Eigen::Vector2d(13, 24.5));
  EXPECT_EQ(r.scratches[0].depth_mm, 0.01);
  EXPECT_EQ(r.scratches[0].line, 7u);
  EXPECT_EQ(r.carve_mm, 5);
  EXPECT_EQ(r.lines, 9u);
  EXPECT_TRUE(r.ended);
  // Marlin's display is told text that is no G-code.
  EXPECT_EQ(replay("G21\nG90\nG0 Z1 F900\nM117 Hello (world) G1 X5\n", "marlin").travel_mm, 0);
}

TEST(Replay, InchesAreInches) {
  const Replay r = replay("G20 G90\nG0 Z1\nG0 X1 Y1\nG1 Z-0.001 F10\nG1 X2 F10\nG0 Z1\n");
  EXPECT_NEAR(r.scratches.at(0).to_mm.x(), 50.8, 1e-12);
  EXPECT_NEAR(r.scratches[0].depth_mm, 0.0254, 1e-12);
}

TEST(Replay, TimeIsTheSumOfTrapezoids) {
  MachineProfile m = machine_profile("grbl");
  const Replay r =
      replay_gcode("G21 G90\nG0 Z1\nG0 X0 Y0\nG0 X100\nG1 Z-0.01 F300\nG4 P0.5\nG1 X110 F1200\nG0 Z1\n", m, "x");
  const double expected =
      move_time_s(100, m.rapid_mm_min, m.acceleration_mm_s2) + move_time_s(1.01, 300, m.acceleration_z_mm_s2) + 0.5 +
      move_time_s(10, 1200, m.acceleration_mm_s2) + move_time_s(1.01, m.rapid_z_mm_min, m.acceleration_z_mm_s2);
  EXPECT_NEAR(r.duration_s, expected, 1e-9);
  EXPECT_EQ(r.travel_mm, 100);
  m.dialect = GcodeDialect::marlin;
  EXPECT_NEAR(replay_gcode("G21\nG90\nG4 P500\nG4 S2\n", m, "x").duration_s, 2.5, 1e-12);
}

TEST(Replay, FaultsAreNamedWithTheirLine) {
  const auto expect = [](const std::string& text, const auto& message) {
    EXPECT_THAT([&] { replay(text); }, ThrowsMessage<Error>(message)) << text;
  };
  const std::string head = kHead;
  expect("G0 X1 Y1\n", AllOf(HasSubstr("file.nc:1"), HasSubstr("before units")));
  expect("G21\nG0 X1 Y1\n", HasSubstr("file.nc:2"));
  expect("G21 G90\nG0 X1 Y1\n", HasSubstr("before the tool was lifted"));
  expect(head + "G2 X1 Y1 I1\n", AllOf(HasSubstr("file.nc:3"), HasSubstr("arc")));
  expect(head + "G91\n", HasSubstr("relative"));
  expect(head + "G92 X0\n", HasSubstr("G92"));
  expect(head + "G38.2 Z-5\n", HasSubstr("unknown code G38"));
  expect(head + "G0 X1 Y1\nG1 Z-1 F9\nG0 X5\nG0 Z1\n",
         AllOf(HasSubstr("file.nc:5"), HasSubstr("G0 through the metal")));
  expect(head + "G0 X1 Y1\nG1 X2 Y1 Z-1 F9\n", HasSubstr("at a slant"));
  expect(head + "G0 X1 Y1\nG1 Z-1 F9\nX3 Z-2\n", HasSubstr("changes depth"));
  expect(head + "G0 X1 Y1\nG1 Z-1\n", HasSubstr("without a feed"));
  expect(head + "G0 X1 Y1\nG1 Z-1 F9\n", HasSubstr("ends with the tool in the metal"));
  expect(head + "G0 X1 X2\n", HasSubstr("X stands twice"));
  expect(head + "G0 Xabc\n", HasSubstr("no number after X"));
  expect(head + "G4\n", HasSubstr("without a time"));
  expect(head + "(open\n", HasSubstr("not closed"));
  expect(head + "#1=5\n", HasSubstr("cannot read \"#\""));
  expect("G21 G90\nG0 Z1\nG28\nG0 X1\n", HasSubstr("before the tool was lifted"));  // home: who knows where that is
}

// What a controller would read otherwise than a person does, each with its line.
TEST(Replay, WhatAControllerWouldMisreadIsRefused) {
  const auto refuses = [](const std::string& line, const std::string& why) {
    EXPECT_THAT([&] { replay("G21 G90\nG0 Z1\nG0 X1 Y1\n" + line + "\n"); },
                ThrowsMessage<Error>(AllOf(HasSubstr("file.nc:4"), HasSubstr(why))))
        << line;
  };
  for (const char* feed : {"G1 X2 F0", "G1 X2 F-100", "G1 X2 F0.001", "F1000001", "F9999999"})
    refuses(feed, "a feed of");
  refuses("G1 X2 F1e-300", "has a word E");
  refuses("G1 X3e10 F100", "has a word E");
  refuses("G1 X" + std::string(300, '9') + " F100", "characters, and the machine reads 79");
  refuses("G1 X" + std::string(60, '9') + " F100", "more digits than controllers read");
  refuses("G1 X0.0000000000000001 F100", "more digits than controllers read");
  refuses("G1 X1000000 F100", "where no machine is");
  refuses("G1 Xnan F100", "no number after X");
  refuses("G1 Xinf F100", "no number after X");
  refuses("G1 X. F100", "no number after X");
  refuses("G1 X1 2 F100", "cannot read \"2\"");
  refuses("G20", "changes the units");
  refuses("G18", "changes the plane");
  refuses("G90.1", "unknown code G90.1");
  refuses("G0 G1 X5 F100", "exclude each other");
  refuses("G1.04 X5 F100", "no such code");
  refuses("G55", "changes where zero is");
  refuses("G43.1 Z5", "shifts or turns the coordinates");
  refuses("G28 Z0", "goes home by a place of the board");
  refuses("G4 P1 X5", "moves in the line of a dwell");
  refuses("G4 P1000000", "rests for");
  refuses("G4 P-1", "rests for");
  refuses("G1 X5 F100 A3", "has a word A");
  refuses("G1 X5 F100 P3", "has a word P");
  refuses("M98 P1", "M98");
  refuses("M6 T1", "M6");
  refuses("$J=G91 X5 F100", "cannot read \"$\"");
  refuses("/G0 X5", "cannot read \"/\"");
  refuses("G0 X5*57", "cannot read \"*\"");
  refuses("%", "cannot read \"%\"");
  refuses("(stop!)", "which grbl obeys at once");
  refuses("(a (comment) in a comment)", "holds another one");
  refuses("(caf\xc3\xa9)", "0xC3");
  refuses(std::string("G0 X5\0", 6), "0x00");
  refuses("G0 X5\rG1 Z-1 F100", "0x0D");
  refuses("(" + std::string(80, 'a') + ")", "82 characters, and the machine reads 79");
}

// Marlin's G28 counts from its switches afterwards: Z zero on a sheet, set by hand, is the table then.
TEST(Replay, MarlinHomesNoAxisThatIsStillUsed) {
  const auto replay = [](const std::string& lines) {
    replay_gcode("G21\nG90\n" + lines, machine_profile("marlin"), "file.gcode");
  };
  for (const char* home : {"G28\n", "G28 Z0\n", "G28 X0 Y0 Z0\n"})
    for (const std::string& lines :
         {home + std::string("G0 Z5 F900\nG0 X1 Y1\n"), "G0 Z5 F900\nG0 X1 Y1\n" + std::string(home)})
      EXPECT_THAT([&] { replay(lines); }, ThrowsMessage<Error>(HasSubstr("forgets where Z zero was set"))) << lines;
  EXPECT_THAT([&] { replay("G28 X0 Y0\nG0 Z5 F900\nG0 X1 Y1\n"); },
              ThrowsMessage<Error>(HasSubstr("forgets where X and Y zero were set")));
  EXPECT_NO_THROW(replay("G0 Z5 F900\nG0 X1 Y1\nG28 X0 Y0\n"));
}

// The tool goes where nothing is carved: through the face, into it, or out of reach.
TEST(Replay, WaysThatSpoilABoardAreRefused) {
  const auto refuses = [](const std::string& lines, const std::string& why, const MachineProfile& machine) {
    EXPECT_THAT([&] { replay_gcode("G21 G90\nG0 Z1\nG0 X1 Y1\n" + lines, machine, "file.nc"); },
                ThrowsMessage<Error>(HasSubstr(why)))
        << lines;
  };
  MachineProfile grbl = machine_profile("grbl");
  refuses("G0 Z0\nG0 X5\n", "travels on the face", grbl);
  refuses("G0 Z0.000000001\nG1 X5 F100\n", "travels on the face", grbl);
  refuses("G0 Z-0.01\n", "into the metal with G0", grbl);
  refuses("G1 Z-5 F100\nG0 Z1\n", "a hole", grbl);
  refuses("G1 Z-5 F100\nG1 Z-0.01\nG1 X5\nG0 Z1\n", "changes its depth in the metal", grbl);
  refuses("G28\nG1 Z-0.01 F100\n", "from a height that is not in the file", grbl);
  refuses("G1 Z-0.01 F100\nG28\n", "home with the tool in the metal", grbl);
  refuses("G53 G0 X0 Y0 Z0\n", "in machine coordinates before the tool was lifted", grbl);
  refuses("M2\nG1 Z-5 F100\n", "goes on after its end", grbl);
  refuses("M3 S1000\n", "ends with the spindle on", grbl);
  EXPECT_NO_THROW(replay_gcode("G21 G90\nG0 Z1\nM3 S1000\nM5\n", grbl, "file.nc"));
  grbl.travel = MachineBounds{{0, 0}, {200, 100}};
  refuses("G0 X1 Y100.01\n", "out of the machine's travel", grbl);
  refuses("G0 X-0.01\n", "out of the machine's travel", grbl);
  EXPECT_NO_THROW(replay_gcode("G21 G90\nG0 Z1\nG0 X200 Y100\n", grbl, "file.nc"));

  // A file that was cut off, for machines whose files have an end.
  const auto ended = [](const std::string& text, const MachineProfile& machine) {
    fail_unless_ended(replay_gcode(text, machine, "file.nc"), machine, "file.nc");
  };
  EXPECT_THAT([&] { ended("G21 G90\nG0 Z1\n", grbl); }, ThrowsMessage<Error>(HasSubstr("has no end")));
  EXPECT_NO_THROW(ended("G21 G90\nG0 Z1\nM2\n", grbl));
  EXPECT_NO_THROW(ended("%\nG21 G90\nG0 Z1\n%\n", machine_profile("linuxcnc")));
  EXPECT_NO_THROW(ended("G21\nG90\nG0 Z1 F900\n", machine_profile("marlin")));
}

// Every dialect by what it alone cannot read, and a person's own machine by its profile.
TEST(Replay, EachDialectHasItsOwnRules) {
  const auto refuses = [](const std::string& text, const std::string& why, const char* machine) {
    EXPECT_THAT([&] { replay(text, machine); }, ThrowsMessage<Error>(HasSubstr(why))) << text;
  };
  refuses("G21 G90\n", "Marlin obeys the first one alone", "marlin");
  refuses("G21\nG90\nG0 Z1 F900\nX5\n", "without saying how", "marlin");
  refuses("(comment)\n", "write it after ;", "marlin");
  refuses("g21\n", "cannot read \"g\"", "marlin");
  refuses("G20\n", "inches", "marlin");
  refuses("(LOGOPEN,/etc/passwd)\n", "LinuxCNC executes", "linuxcnc");
  refuses("( p\tY ,x)\n", "LinuxCNC executes", "linuxcnc");
  refuses("G28\n(a)\n%\n", "within the program", "linuxcnc");
  refuses(";py,print()\n", "LinuxCNC executes", "linuxcnc");
  refuses("%\nG21 G90\n%\nG0 Z1\n", "after its end", "linuxcnc");
  refuses("M5 S0\nG21 G90\nG0 Z1\nM3 S5\n", "laser on", "laser-z");
  refuses("N5 G21\n", "a line number, and Marlin requests", "marlin");
  for (const char* code : {"M7", "M62 P0", "M64 P0", "M67 E0 Q5", "M68 E0 Q5"}) {
    refuses(std::string("G21 G90\n") + code + "\n", "which grbl answers by an error", "grbl");
    EXPECT_NO_THROW(replay(std::string("G21 G90\n") + code + "\n", "linuxcnc")) << code;
  }
  EXPECT_NO_THROW(replay("(" + std::string(100, 'a') + ")\nG21 G90\n", "linuxcnc"));

  MachineProfile own = machine_profile("grbl");
  own.max_line_characters = 40;
  EXPECT_THAT([&] { replay_gcode("(" + std::string(45, 'a') + ")\n", own, "x"); },
              ThrowsMessage<Error>(HasSubstr("reads 40")));
  EXPECT_THAT([&] { replay_gcode("M42 P1\n", own, "x"); }, ThrowsMessage<Error>(HasSubstr("other_m_codes")));
  own.other_m_codes = {42, 67};
  EXPECT_NO_THROW(replay_gcode("M42 P1\nM67 E0 Q5\n", own, "x"));  // grblHAL
}

// LinuxCNC rounds corners unless it is told not to: by 50 mm, if it is told so.
TEST(Replay, LinuxcncHasToKeepToThePath) {
  const auto file = [](const std::string& mode) {
    return "G21 G90\n" + mode + "\nG0 Z1\nG0 X1 Y1\nG1 Z-0.01 F100\nG1 X5 F500\nG0 Z1\nM2\n";
  };
  for (const char* mode : {"G61", "G61.1", "G64 P0.001", "G64 P0.005 Q0.001"})
    EXPECT_EQ(replay(file(mode), "linuxcnc").scratches.size(), 1u) << mode;
  for (const char* mode : {"", "G64", "G64 P50", "G64 P0.006", "G64 Q0.001", "G64 P0.001 Q0.1", "G61\nG64 P0.05"})
    EXPECT_THAT([&] { replay(file(mode), "linuxcnc"); },
                ThrowsMessage<Error>(AllOf(HasSubstr("file.nc:"), HasSubstr("G61"))))
        << mode;
  const std::string inches = "G20 G90\nG64 P0.0005\n";  // 12.7 um
  EXPECT_THAT([&] { replay(inches, "linuxcnc"); }, ThrowsMessage<Error>(HasSubstr("by 0.0127 mm")));
  EXPECT_NO_THROW(replay("G21 G90\nG0 Z1\nG0 X5\nM2\n", "linuxcnc"));  // in the air it does not matter
}

// Marlin stops Z at zero without a word unless it is told not to.
TEST(Replay, MarlinHasToLetZBelowZero) {
  const auto file = [](const std::string& first) {
    return first + "G21\nG90\nG0 Z1 F900\nG0 X1 Y1 F900\nG1 Z-0.01 F100\nG1 X5 F500\nG0 Z1 F900\n";
  };
  EXPECT_EQ(replay(file("M211 S0\n"), "marlin").scratches.size(), 1u);
  for (const char* first : {"", "M211\n", "M211 S1\n", "M211 S0\nM211 S1\n"})
    EXPECT_THAT([&] { replay(file(first), "marlin"); },
                ThrowsMessage<Error>(AllOf(HasSubstr("software endstops"), HasSubstr("M211 S0"))))
        << first;
  EXPECT_THAT([&] { replay("M211 S5\n", "marlin"); }, ThrowsMessage<Error>(HasSubstr("neither on nor off")));
}

// A head names what its file carves: one that was cut off between two scratches is found, also where no end is wanted.
TEST(Replay, AFileThatWasCutOffBetweenTwoScratchesIsFound) {
  const auto ended = [](const std::string& text, const char* machine) {
    const MachineProfile profile = machine_profile(machine);
    fail_unless_ended(replay_gcode(text, profile, "file.nc"), profile, "file.nc");
  };
  const std::string head = "; Burin tool path for marlin, mm\n; part 2 of 3, scratches 11 to 12\n; - of 40\n",
                    start = "M211 S0\nG21\nG90\nG0 Z1 F900\n",
                    first = "G0 X1 Y1 F900\nG1 Z-0.01 F100\nG1 X5 F500\nG0 Z1 F900\n",
                    second = "G0 X1 Y2 F900\nG1 Z-0.01 F100\nG1 X5 F500\nG0 Z1 F900\n";
  EXPECT_NO_THROW(ended(head + start + first + second, "marlin"));
  EXPECT_NO_THROW(ended(start + first, "marlin"));  // another program's: nobody knows
  EXPECT_THAT([&] { ended(head + start + first, "marlin"); },
              ThrowsMessage<Error>(AllOf(HasSubstr("carves 1 scratch of the 2 that its head names"),
                                         HasSubstr("part 2 of 3, scratches 11 to 12 of 40"), HasSubstr("cut off"))));
}

TEST(ToolpathCheck, FarAndNoPlacesAreForeign) {
  std::vector<PlannedScratch> p{{0, {1e300, 0}, {1e300, 5}, 0.01}, {1, {0, 0}, {3, 4}, 0.01}};
  std::vector<ReplayedScratch> c{{{0, 0}, {3, 4}, 0.01, 1}, {{-1e308, 1e308}, {std::nan(""), 1}, 0.01, 2}};
  const ToolpathCheck check = check_toolpath(c, p, 1e-3);
  EXPECT_EQ(check.lost, 1u);
  EXPECT_EQ(check.foreign, 1u);
}

std::vector<PlannedScratch> planned() {
  std::vector<PlannedScratch> p;
  for (int i = 0; i < 20; ++i)
    p.push_back({static_cast<std::uint32_t>(i), {1.5 * i, 0.1 * i * i}, {1.5 * i + 3, 0.1 * i * i + 1 + i % 3}, 0.01});
  return p;
}

std::vector<ReplayedScratch> carved() {
  std::vector<ReplayedScratch> c;
  for (const PlannedScratch& p : planned()) c.push_back({p.from_mm, p.to_mm, p.depth_mm, 10 + c.size()});
  return c;
}

TEST(ToolpathCheck, GoodInAnyOrderAndFromEitherEnd) {
  auto c = carved();
  std::swap(c[3], c[11]);
  std::swap(c[5].from_mm, c[5].to_mm);
  c[6].from_mm.x() += 0.9e-3;
  const ToolpathCheck check = check_toolpath(c, planned(), 1e-3);
  EXPECT_TRUE(check.good());
  EXPECT_NO_THROW(fail_unless_good(check, "file.nc"));
}

TEST(ToolpathCheck, LostDoubledForeignAndWrongDepth) {
  auto c = carved();
  c.erase(c.begin() + 7);
  c.push_back(c[2]);
  c[4].to_mm.y() += 0.01;
  c[9].depth_mm = 0.1;
  const ToolpathCheck check = check_toolpath(c, planned(), 1e-3);
  EXPECT_EQ(check.lost, 3u);
  EXPECT_EQ(check.doubled, 1u);
  EXPECT_EQ(check.foreign, 2u);
  EXPECT_EQ(check.first_lost, 4u);
  EXPECT_EQ(check.first_foreign_line, 14u);
  EXPECT_THAT(
      [&] { fail_unless_good(check, "file.nc"); },
      ThrowsMessage<Error>(AllOf(HasSubstr("file.nc"), HasSubstr("3 scratches lost (the first in row 5)"),
                                 HasSubstr("1 scratch carved twice"), HasSubstr("2 scratches never asked for"))));
}

TEST(ToolpathCheck, TwoPlannedInOnePlaceAreNotOneDoubled) {
  auto p = planned();
  p.push_back(p[3]);
  auto c = carved();
  EXPECT_EQ(check_toolpath(c, p, 1e-3).lost, 1u);
  c.push_back(c[3]);
  EXPECT_TRUE(check_toolpath(c, p, 1e-3).good());
}

TEST(ToolpathCheck, MirroredFilesAreCalledThat) {
  for (const int axis : {0, 1}) {
    auto c = carved();
    for (auto& s : c) s.from_mm[axis] = 100 - s.from_mm[axis], s.to_mm[axis] = 100 - s.to_mm[axis];
    const ToolpathCheck check = check_toolpath(c, planned(), 1e-3);
    EXPECT_EQ(check.mirrored, 20u);
    EXPECT_THAT([&] { fail_unless_good(check, "file.nc"); }, ThrowsMessage<Error>(HasSubstr("is mirrored")));
  }
}

}  // namespace
}  // namespace burin
