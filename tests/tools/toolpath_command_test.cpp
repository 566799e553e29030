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
using ::testing::Not;

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
  // Carving comes after the check, whose command is the next one.
  EXPECT_THAT(made.out, AllOf(Not(HasSubstr("and carve")),
                              HasSubstr("next: burin check carve scratches.csv --board board.json --machine grbl "
                                        "--gcode board.gcode\n")));
  EXPECT_THAT(file_text(folder / "board.gcode"), HasSubstr("G21 G90"));
  EXPECT_THAT(file_text(folder / "carved.csv"), HasSubstr("10.00000,10.00000,14.00000,12.00000\n14.00000,13.00000"));
  const Outcome replayed =
      run_burin(folder, {"toolpath", "scratches.csv", "--board", "board.json", "--replay", "board.gcode"});
  EXPECT_EQ(replayed.exit_code, 0) << replayed.err;
  EXPECT_THAT(replayed.out, HasSubstr("3 scratches, each carved once"));
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
  EXPECT_THAT(rest.out, AllOf(HasSubstr("1 scratch done before line " + std::to_string(line)),
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

// No output is an input, by whatever name, and no two outputs are one file.
TEST(ToolpathCommand, WhatIsReadIsNotReplaced) {
  const TemporaryFolder folder;
  folder.write("board.json", kPlainBoard);
  folder.write("scratches.csv", kThreeScratches);
  const std::string board = kPlainBoard, scratches = kThreeScratches;
  const auto run = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"toolpath", "scratches.csv", "--board", "board.json"});
    return run_burin(folder, more);
  };
  ASSERT_EQ(run({"--out", "old.gcode", "--chunks", "1"}).exit_code, 0);  // in parts: old-01.gcode, ...
  const std::string part = file_text(folder / "old-01.gcode");
  std::filesystem::create_symlink(folder / "scratches.csv", folder / "link.csv");
  std::filesystem::create_hard_link(folder / "scratches.csv", folder / "hard.csv");
  std::filesystem::create_directory(folder / "sub");
  const std::size_t files = folder.file_count();
  const auto refused = [&](const std::vector<std::string>& more, const char* why) {
    const Outcome outcome = run(more);
    EXPECT_EQ(outcome.exit_code, 1) << outcome.out;
    EXPECT_THAT(outcome.err, AllOf(HasSubstr(why), HasSubstr("another")));
    EXPECT_EQ(folder.file_count(), files);
    EXPECT_EQ(file_text(folder / "scratches.csv"), scratches);
    EXPECT_EQ(file_text(folder / "board.json"), board);
    EXPECT_EQ(file_text(folder / "old-01.gcode"), part);
  };
  const char* const read = "is an input of this command";
  for (const char* out : {"scratches.csv", "./scratches.csv", "sub/../scratches.csv", "link.csv", "hard.csv"}) {
    refused({"--out", out}, read);
    refused({"--out=" + std::string(out)}, read);
    refused({"--out", "d.gcode", "--sent", out}, read);
  }
  refused({"--out", "d.csv", "--sent", "d.csv"}, "is named twice");
  refused({"--out", "d.csv", "--sent", "sub/../d.csv"}, "is named twice");
  const std::size_t line = static_cast<std::size_t>(std::count(part.begin(), part.end(), '\n')) - 3;
  refused({"--out", "old-01.gcode", "--resume", "old-01.gcode", "--at-line", std::to_string(line)}, "name another one");
  // Other commands that take --out.
  const auto other = [&](const std::vector<std::string>& command) {
    const Outcome outcome = run_burin(folder, command);
    EXPECT_EQ(outcome.exit_code, 1) << outcome.out;
    EXPECT_THAT(outcome.err, HasSubstr("another name"));
    EXPECT_EQ(file_text(folder / "board.json"), board);
  };
  ASSERT_EQ(run({"--out", "whole.gcode"}).exit_code, 0);
  for (const char* out : {"board.json", "scratches.csv"})  // an input; a file of another kind
    other({"probe", "write", "board.json", "--out", out});
  for (const char* out : {"scratches.csv", "board.json", "whole.gcode", "hard.csv"})
    other({"check", "carve", "scratches.csv", "--board", "board.json", "--gcode", "whole.gcode", "--out", out});
  EXPECT_EQ(file_text(folder / "scratches.csv"), scratches);
  EXPECT_EQ(run({"--out", "scratches.gcode", "--sent", "sub/scratches.csv"}).exit_code, 0);
  EXPECT_EQ(run({"--out", "scratches.gcode", "--sent", "sub/scratches.csv"}).exit_code, 0);  // its own, again
}

TEST(ToolpathCommand, NamesWhatItRemovesAndLeavesOtherJobs) {
  const TemporaryFolder folder;
  folder.write("board.json", kPlainBoard);
  folder.write("scratches.csv", kThreeScratches);
  const auto run = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"toolpath", "scratches.csv", "--board", "board.json", "--out"});
    return run_burin(folder, more);
  };
  for (const char* other : {"job-1.gcode", "job-2026.gcode"}) EXPECT_EQ(run({other}).exit_code, 0);
  EXPECT_EQ(run({"job.gcode", "--chunks", "1"}).exit_code, 0);
  const Outcome whole = run({"job.gcode"});
  EXPECT_THAT(whole.out, HasSubstr("job-02.gcode  removed: it was part of an earlier tool path of this name"));
  EXPECT_EQ(whole.out.find("job-1.gcode"), std::string::npos);
  EXPECT_EQ(folder.file_count(), 5u);
  EXPECT_EQ(run({"job.svg", "--max-lines", "900"}).exit_code, 1);
  EXPECT_EQ(run({"job.dxf", "--frame"}).exit_code, 1);
}

// What public readers make of drawings and of G-code: a line "x0 y0 x1 y1" in mm, y up, for each scratch.
class OtherReaders : public ::testing::Test {
 protected:
  // Runs `script` (its last lines print the scratches of argv[1]) on FILE; skips where its modules are missing.
  void expect_read(const std::string& file, const std::string& modules, const std::string& from,
                   const std::string& script, const std::vector<std::string>& options = {}) {
    if (run_shell(folder_, "python3 -c 'import " + modules + "'").exit_code != 0)
      GTEST_SKIP() << "needs " << from << ", which python3 cannot import here";
    folder_.write("board.json", kPlainBoard);
    folder_.write("scratches.csv",
                  "x0_mm,y0_mm,x1_mm,y1_mm,depth_um\n10,10,14,12,8\n90,70,85,70,12.5\n14,13,15,19,8\n");
    std::vector<std::string> command{"toolpath", "scratches.csv", "--board", "board.json", "--out",
                                     file,       "--order",       "keep"};
    command.insert(command.end(), options.begin(), options.end());
    ASSERT_EQ(run_burin(folder_, command).exit_code, 0);
    folder_.write("read.py", script);
    const std::string at = quoted(folder_.path().string());
    const Outcome read = run_shell(folder_, "cd " + at + " && python3 read.py " + quoted(file));
    EXPECT_EQ(read.exit_code, 0) << read.err;
    EXPECT_EQ(read.out, "10.000 10.000 14.000 12.000\n90.000 70.000 85.000 70.000\n14.000 13.000 15.000 19.000\n")
        << read.err;
  }
  TemporaryFolder folder_;
};

// Layers change the order.
constexpr const char* kPrintInOrder =
    "lines.sort(key=lambda line: [10, 90, 14].index(round(line[0])))\n"
    "for line in lines: print('%.3f %.3f %.3f %.3f' % tuple(line))\n";

TEST_F(OtherReaders, EzdxfReadsTheDxf) {
  expect_read("b.dxf", "ezdxf", "Debian's python3-ezdxf", std::string(R"(
import sys, ezdxf
doc = ezdxf.readfile(sys.argv[1])
audit = doc.audit()
assert not audit.errors, audit.errors
assert doc.header['$INSUNITS'] == 4 and doc.header['$MEASUREMENT'] == 1
assert sorted({e.dxf.layer for e in doc.modelspace()}) == ['DEPTH_12_5_UM', 'DEPTH_8_0_UM']
assert all(e.dxf.layer in doc.layers for e in doc.modelspace())
lines = [[e.dxf.start.x, e.dxf.start.y, e.dxf.end.x, e.dxf.end.y] for e in doc.modelspace().query('LINE')]
)") + kPrintInOrder);
}

TEST_F(OtherReaders, SvgelementsReadsTheSvg) {
  expect_read("b.svg", "svgelements", "Debian's python3-svgelements", std::string(R"(
import sys, svgelements
svg = svgelements.SVG.parse(sys.argv[1], ppi=25.4)  # a pixel is then a millimeter
assert abs(svg.width - 100) < 1e-3 and abs(svg.height - 80) < 1e-3
paths = [e for e in svg.elements() if isinstance(e, svgelements.Path)]
lines = [[p.first_point.x, 80 - p.first_point.y, p.current_point.x, 80 - p.current_point.y] for p in paths]
)") + kPrintInOrder);
}

TEST_F(OtherReaders, SvgpathtoolsReadsTheSvg) {
  expect_read("b.svg", "svgpathtools", "PyPI's svgpathtools", std::string(R"(
import sys, svgpathtools
paths, _, attributes = svgpathtools.svg2paths2(sys.argv[1])
assert attributes['width'] == '100mm' and attributes['viewBox'] == '0 0 100 80'
lines = [[p.start.real, 80 - p.start.imag, p.end.real, 80 - p.end.imag] for p in paths]
)") + kPrintInOrder);
}

TEST_F(OtherReaders, SvgToGcodeReadsTheSvg) {
  expect_read("b.svg", "svg_to_gcode", "PyPI's svg-to-gcode", std::string(R"(
import sys
from svg_to_gcode.svg_parser import parse_file
lines = [[c.start.x, c.start.y, c.end.x, c.end.y] for c in parse_file(sys.argv[1])]
)") + kPrintInOrder);
}

TEST_F(OtherReaders, PygcodeReadsTheGcode) {
  expect_read("b.gcode", "pygcode", "PyPI's pygcode", std::string(R"(
import sys, pygcode
at, lines = {}, []
for text in open(sys.argv[1]):
    line = pygcode.Line(text)
    assert len(text) <= 71
    for code in line.block.gcodes:
        to = dict(at, **{k: v for k, v in code.get_param_dict().items() if k in 'XYZ'})
        if str(code.word_key) == 'G01' and ('X' in code.get_param_dict()):
            lines.append([at['X'], at['Y'], to['X'], to['Y']])
        at = to
)") + kPrintInOrder);
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
  EXPECT_EQ(run({"--out", "a.stl"}).exit_code, 1);
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
