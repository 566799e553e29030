// Proves: `burin toolpath` writes what it says and nothing when it cannot, with the exit codes that scripts rely on.
// What the files hold is tested in tests/optimize.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "tests/tools/program.h"

namespace burin {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr const char* kBoard = R"({"format": "burin/board", "version": 1, "size_mm": [100, 80]})";
constexpr const char* kScratches = "x0_mm,y0_mm,x1_mm,y1_mm\n10,10,14,12\n90,70,85,70\n14,13,15,19\n";

TEST(ToolpathCommand, WritesAndReplays) {
  const TemporaryFolder folder;
  folder.write("board.json", kBoard);
  folder.write("scratches.csv", kScratches);
  const Outcome made = run_burin(folder, {"toolpath", "scratches.csv", "--board", "board.json", "--machine", "grbl",
                                          "--out", "board.gcode", "--ordered", "carved.csv"});
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
  folder.write("board.json", kBoard);
  folder.write("scratches.csv", kScratches);
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

TEST(ToolpathCommand, SaysWhatIsWrongAndWritesNothing) {
  const TemporaryFolder folder;
  folder.write("board.json", kBoard);
  folder.write("scratches.csv", std::string(kScratches) + "10,10,10,10\n");
  const auto run = [&](std::vector<std::string> more) {
    std::vector<std::string> arguments{"toolpath", "scratches.csv", "--board", "board.json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_burin(folder, arguments);
  };
  const Outcome zero_length = run({"--out", "a.gcode"});
  EXPECT_EQ(zero_length.exit_code, 1);
  EXPECT_THAT(zero_length.err, AllOf(HasSubstr("scratches.csv:5"), HasSubstr("no length")));
  folder.write("scratches.csv", kScratches);
  EXPECT_EQ(run({"--out", "a.cnc"}).exit_code, 1);
  EXPECT_EQ(run({"--out", "no/folder/a.gcode"}).exit_code, 1);
  EXPECT_EQ(run({"--out", "a.gcode", "--machine", "toaster"}).exit_code, 1);
  EXPECT_EQ(run({"--out", "a.gcode", "--chunks", "soon"}).exit_code, 1);
  EXPECT_EQ(run({"--out", "a.gcode", "--bench", "none.json"}).exit_code, 1);
  EXPECT_EQ(run({}).exit_code, 2);
  EXPECT_EQ(run({"--out", "a.gcode", "--replay", "a.gcode"}).exit_code, 2);
  EXPECT_EQ(folder.file_count(), 2u);
}

}  // namespace
}  // namespace burin
