// Proves: `burin toolpath` writes what it says and nothing when it cannot, with the exit codes that scripts rely on.
// What the files hold is tested in tests/optimize.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <sstream>
#include <string>
#include <vector>

#include "tests/tools/program.h"

namespace burin {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr const char* kPlainBoard = R"({"format": "burin/board", "version": 1, "size_mm": [100, 80]})";
constexpr const char* kThreeScratches = "x0_mm,y0_mm,x1_mm,y1_mm\n10,10,14,12\n90,70,85,70\n14,13,15,19\n";

TEST(ToolpathCommand, WritesAndReplays) {
  const TemporaryFolder folder;
  folder.write("board.json", kPlainBoard);
  folder.write("scratches.csv", kThreeScratches);
  const Outcome made = run_burin(folder, {"toolpath", "scratches.csv", "--board", "board.json", "--machine", "grbl",
                                          "--out", "board.gcode", "--sent", "carved.csv"});
  EXPECT_EQ(made.exit_code, 0) << made.err;
  EXPECT_THAT(made.out, AllOf(HasSubstr("3 scratches"), HasSubstr("not compensated")));
  EXPECT_THAT(file_text(folder / "board.gcode"), HasSubstr("G21 G90"));
  EXPECT_THAT(file_text(folder / "carved.csv"), HasSubstr("10.00000,10.00000,14.00000,12.00000\n14.00000,13.00000"));
  const Outcome replayed =
      run_burin(folder, {"toolpath", "scratches.csv", "--board", "board.json", "--replay", "board.gcode"});
  EXPECT_EQ(replayed.exit_code, 0) << replayed.err;
  EXPECT_THAT(replayed.out, HasSubstr("all 3 scratches"));
}

TEST(ToolpathCommand, GoesOnAfterAnInterruption) {
  const TemporaryFolder folder;
  folder.write("board.json", kPlainBoard);
  folder.write("scratches.csv", kThreeScratches);
  const std::vector<std::string> command{"toolpath", "scratches.csv", "--board", "board.json", "--out"};
  const auto run = [&](std::vector<std::string> more) {
    more.insert(more.begin(), command.begin(), command.end());
    return run_burin(folder, more);
  };
  EXPECT_EQ(run({"board.gcode"}).exit_code, 0);
  const std::string gcode = file_text(folder / "board.gcode");
  // Stopped while the second of three was carved: its line with both G1 and X.
  std::size_t at = gcode.find("G1 X");
  at = gcode.find("G1 X", at + 1);
  const auto line = std::count(gcode.begin(), gcode.begin() + static_cast<std::ptrdiff_t>(at), '\n') + 1;
  const Outcome rest = run({"rest.gcode", "--resume", "board.gcode", "--at-line", std::to_string(line)});
  EXPECT_EQ(rest.exit_code, 0) << rest.err;
  EXPECT_THAT(rest.out, AllOf(HasSubstr("1 scratches are done before line " + std::to_string(line)),
                              HasSubstr("Wrote the 2 scratches left")));
  const Outcome again = run({"board.gcode", "--resume", "board.gcode", "--at-line", std::to_string(line)});
  EXPECT_EQ(again.exit_code, 1);
  EXPECT_EQ(file_text(folder / "board.gcode"), gcode);
  EXPECT_EQ(run({"rest.gcode", "--resume", "board.gcode"}).exit_code, 2);
}

TEST(ToolpathCommand, FollowsAProbedSheet) {
  const TemporaryFolder folder;
  folder.write("board.json", R"({"format": "burin/board", "version": 1, "size_mm": [100, 80], "flatness_um": 60})");
  folder.write("scratches.csv", kThreeScratches);
  const std::vector<std::string> command{"toolpath", "scratches.csv", "--board", "board.json"};
  const auto run = [&](std::vector<std::string> more) {
    more.insert(more.begin(), command.begin(), command.end());
    return run_burin(folder, more);
  };
  const Outcome fixed = run({"--out", "a.gcode"});
  EXPECT_EQ(fixed.exit_code, 1);
  EXPECT_THAT(fixed.err, AllOf(HasSubstr("60 um higher in one place"), HasSubstr("burin probe write")));
  EXPECT_FALSE(std::filesystem::exists(folder / "a.gcode"));

  const Outcome written =
      run_burin(folder, {"probe", "write", "board.json", "--spacing", "20", "--out", "probe.gcode"});
  EXPECT_EQ(written.exit_code, 0) << written.err;
  EXPECT_THAT(written.out, HasSubstr("burin probe read SERIAL_LOG --probed probe.gcode --out heights.json"));
  // grbl's answers of a sheet that rises by 0.6 um a mm to the right.
  std::string log, place = "0 0";
  std::istringstream lines(file_text(folder / "probe.gcode"));
  for (std::string line; std::getline(lines, line);) {
    double x = 0, y = 0;
    if (std::sscanf(line.c_str(), "G0 X%lf Y%lf", &x, &y) == 2)
      place = fmt::format("{:.3f},{:.3f},{:.3f}", x - 300, y - 200, 6e-4 * x - 40);
    if (line.starts_with("G38.2")) log += "[PRB:" + place + ":1]\nok\n";
  }
  folder.write("serial.log", log);
  const Outcome read =
      run_burin(folder, {"probe", "read", "serial.log", "--probed", "probe.gcode", "--out", "heights.json"});
  EXPECT_EQ(read.exit_code, 0) << read.err;
  EXPECT_THAT(read.out, AllOf(HasSubstr("30 points, 60.0 um from the lowest to the highest"), HasSubstr("--heights")));
  const Outcome followed = run({"--heights", "heights.json", "--out", "a.gcode"});
  EXPECT_EQ(followed.exit_code, 0) << followed.err;
  EXPECT_THAT(followed.out, HasSubstr("Z where the tool touches the face at X0.00 Y0.00"));
  EXPECT_THAT(file_text(folder / "a.gcode"), HasSubstr("G1 X14.0000 Y12.0000 Z-0.0016 F1200"));  // 10 um under 8.4
  const Outcome replayed = run({"--heights", "heights.json", "--replay", "a.gcode"});
  EXPECT_EQ(replayed.exit_code, 0) << replayed.err;
  EXPECT_EQ(run({"--replay", "a.gcode"}).exit_code, 1);
  EXPECT_EQ(run({"--heights", "heights.json", "--follow-bow", "--out", "b.gcode"}).exit_code, 2);
  folder.write("serial.log", log.substr(0, log.find("[PRB", log.size() / 2)));
  const Outcome half = run_burin(folder, {"probe", "read", "serial.log", "--probed", "probe.gcode", "--out", "h.json"});
  EXPECT_EQ(half.exit_code, 1);
  EXPECT_THAT(half.err, HasSubstr("probed points of 33; let the probing file run to its end"));
  EXPECT_FALSE(std::filesystem::exists(folder / "h.json"));
}

TEST(ToolpathCommand, SaysWhatIsWrongAndWritesNothing) {
  const TemporaryFolder folder;
  folder.write("board.json", kPlainBoard);
  folder.write("scratches.csv", std::string(kThreeScratches) + "10,10,10,10\n");
  const auto run = [&](std::vector<std::string> more) {
    std::vector<std::string> arguments{"toolpath", "scratches.csv", "--board", "board.json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_burin(folder, arguments);
  };
  const Outcome zero_length = run({"--out", "a.gcode"});
  EXPECT_EQ(zero_length.exit_code, 1);
  EXPECT_THAT(zero_length.err, AllOf(HasSubstr("scratches.csv:5"), HasSubstr("no length")));
  folder.write("scratches.csv", kThreeScratches);
  EXPECT_EQ(run({"--out", "a.cnc"}).exit_code, 1);
  EXPECT_EQ(run({"--out", "no/folder/a.gcode"}).exit_code, 1);
  EXPECT_EQ(run({"--out", "a.gcode", "--machine", "toaster"}).exit_code, 1);
  EXPECT_EQ(run({"--out", "a.gcode", "--chunks", "soon"}).exit_code, 2);
  EXPECT_EQ(run({"--out", "a.gcode", "--bench", "none.json"}).exit_code, 1);
  EXPECT_EQ(run({}).exit_code, 2);
  EXPECT_EQ(run({"--out", "a.gcode", "--replay", "a.gcode"}).exit_code, 2);
  EXPECT_EQ(folder.file_count(), 2u);
}

}  // namespace
}  // namespace burin
