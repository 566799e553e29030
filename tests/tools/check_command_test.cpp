// burin check carve writes its page and ends with 1 where there is an error (what is one, tests/optimize proves).
// burin check ndf, as a person runs it: a line of value and error and a line of gradient for each row, a summary, and
// an exit code that says whether all rows are within their tolerance. That the values are right is
// footprint_integral_test's.
#include <gmock/gmock.h>

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/places.h"
#include "tests/tools/program.h"
#include "tools/check_file.h"

namespace burin {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

// alpha 1: D is 1 / pi, so the value is the footprint's area, 0.02 x 0.03 mm, over pi.
std::string table(const std::string& value) {
  return "id,kind,hx,hy,hz,alpha,width_um,depth_um,L_mm,x0_mm,y0_mm,x1_mm,y1_mm,x2_mm,y2_mm,x3_mm,y3_mm,Dhat_mm2\n"
         "first,rough,0,0,1,1,400,18.4,10,-0.01,1,0.01,1,0.01,1.03,-0.01,1.03,1.9098593171027440292e-4\n"
         "second,rough,0,0,2,1,400,18.4,10,0.01,1,-0.01,1,-0.01,1.03,0.01,1.03," +
         value + "\n";
}

TEST(CheckNdf, RightRowsAreOk) {
  const TemporaryFolder folder;
  folder.write("cases.csv", table("1.9098593171027440292e-4"));
  const Outcome run = run_burin(folder, {"check", "ndf", "cases.csv"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, AllOf(HasSubstr("first"), HasSubstr("second"), HasSubstr("dDhat_dx0="),
                             HasSubstr("2 rows, 2 within tolerance")));
  const Outcome brief = run_burin(folder, {"check", "ndf", "cases.csv", "--brief"});
  EXPECT_EQ(brief.exit_code, 0);
  EXPECT_EQ(brief.out.find("dDhat_dx0="), std::string::npos);
}

TEST(CheckNdf, AWrongRowIsSaid) {
  const TemporaryFolder folder;
  folder.write("cases.csv", table("1.90986e-4"));
  const Outcome run = run_burin(folder, {"check", "ndf", "cases.csv"});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.out, AllOf(HasSubstr("VALUE"), HasSubstr("2 rows, 1 within tolerance")));
  EXPECT_THAT(run.err, AllOf(HasSubstr("cases.csv"), HasSubstr("1 of 2 rows")));
}

TEST(CheckNdf, ABrokenTableIsNamed) {
  const TemporaryFolder folder;
  EXPECT_EQ(run_burin(folder, {"check", "ndf", "none.csv"}).exit_code, 1);
  folder.write("cases.csv", table("nan"));
  const Outcome run = run_burin(folder, {"check", "ndf", "cases.csv"});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.err, HasSubstr("cases.csv:3: Dhat_mm2"));
  EXPECT_EQ(run.out, "");
}

constexpr const char* kBoard = R"({"format": "burin/board", "version": 1, "size_mm": [100, 80],
  "tags": {"list": [{"id": 2, "center_mm": [50, 40], "size_mm": 8}]}})";
constexpr const char* kScratches = "x0_mm,y0_mm,x1_mm,y1_mm\n10,10,14,12\n90,70,85,70\n14,13,15,19\n";

TEST(CheckCarve, OnePageAndOneQuestion) {
  const TemporaryFolder folder;
  folder.write("board.json", kBoard);
  folder.write("scratches.csv", kScratches);
  ASSERT_EQ(run_burin(folder, {"toolpath", "scratches.csv", "--board", "board.json", "--frame", "--out", "a.gcode"})
                .exit_code,
            0);
  const std::vector<std::string> command{"check", "carve",   "scratches.csv", "--board", "board.json",
                                         "--out", "my.html", "--gcode",       "a.gcode", "a-frame.gcode"};
  const Outcome good = run_burin(folder, command);
  EXPECT_EQ(good.exit_code, 0) << good.err;
  EXPECT_THAT(good.out, AllOf(HasSubstr("warning: the sheet's flatness is unknown"), HasSubstr("a.gcode  3 scratches"),
                              HasSubstr("a-frame.gcode  carves nothing"), HasSubstr("Z -0.0100 to 5.3000 mm"),
                              HasSubstr("Is the sheet clamped"), HasSubstr("Wrote my.html")));
  const std::string page = file_text(folder / "my.html");
  EXPECT_THAT(page, AllOf(HasSubstr("No error."), HasSubstr("Is the sheet clamped"), HasSubstr("</html>")));
  EXPECT_EQ(page.find("src=\"http"), std::string::npos);

  // A person's hand in the file: the second scratch over the tag.
  std::string gcode = file_text(folder / "a.gcode");
  const auto at = gcode.find("X90.0000 Y70.0000");
  ASSERT_NE(at, std::string::npos);
  folder.write("a.gcode", gcode.replace(at, 17, "X50.0000 Y40.0000"));
  const Outcome wrong = run_burin(folder, command);
  EXPECT_EQ(wrong.exit_code, 1);
  EXPECT_THAT(wrong.out, AllOf(HasSubstr("error: 1 scratch would be carved over tag 2"),
                               HasSubstr("error: a.gcode:19: carves over tag 2"), HasSubstr("1 scratch lost")));
  EXPECT_THAT(wrong.err, HasSubstr("my.html: do not carve this: 3 errors; open it"));
  EXPECT_THAT(file_text(folder / "my.html"), AllOf(HasSubstr("Do not carve this"), HasSubstr("over tag 2")));
  EXPECT_EQ(file_text(folder / "my.html").find("Is the sheet clamped"), std::string::npos);
}

TEST(CheckCarve, AToolPathOlderThanItsHeightMapIsAnError) {
  const TemporaryFolder folder;
  folder.write("board.json", kBoard);
  folder.write("scratches.csv", kScratches);
  folder.write("heights.json", R"({"format": "burin/heights", "version": 1, "zero_mm": [0, 0], "first_mm": [0, 0],
    "step_mm": [50, 40], "z_mm": [[0, 0, 0], [0, 0, 0], [0, 0, 0]]})");
  ASSERT_EQ(run_burin(folder, {"toolpath", "scratches.csv", "--board", "board.json", "--heights", "heights.json",
                               "--out", "a.gcode"})
                .exit_code,
            0);
  const std::vector<std::string> command{"check",     "carve",        "scratches.csv", "--board", "board.json",
                                         "--heights", "heights.json", "--gcode",       "a.gcode"};
  const Outcome good = run_burin(folder, command);
  EXPECT_EQ(good.exit_code, 0) << good.out << good.err;
  // The sheet is probed again: the very same map, yet nobody looked at it when the tool path was made.
  const auto later = std::filesystem::last_write_time(folder / "a.gcode") + std::chrono::seconds(5);
  std::filesystem::last_write_time(folder / "heights.json", later);
  const Outcome wrong = run_burin(folder, command);
  EXPECT_EQ(wrong.exit_code, 1);
  EXPECT_THAT(wrong.out, HasSubstr("error: a.gcode: was written before heights.json"));
}

TEST(CheckCarve, TheRoundOfALoop) {
  const TemporaryFolder folder;
  const std::filesystem::path sample = std::filesystem::path(places::source()) / "samples" / "small-bench";
  std::filesystem::copy(sample, folder / "p", std::filesystem::copy_options::recursive);
  const auto round = folder / "p" / "round-01";
  std::filesystem::create_directories(round);
  ASSERT_EQ(run_burin(folder, {"design", "p/design.json", "--count", "300", "--pixels", "48", "--iterations", "2",
                               "--report-tolerance", "--out", "p/round-01/design"})
                .exit_code,
            0);
  std::filesystem::copy_file(round / "design" / "scratches.csv", round / "scratches.csv");
  std::string design = file_text(folder / "p" / "design.json");
  for (const std::string name : {"board.json", "bench.json", "targets/moon", "targets/boat", "targets/still"})
    design.replace(design.find(name), name.size(), "../" + name);
  folder.write("p/round-01/design.json", design);
  const Outcome none = run_burin(folder, {"check", "carve", "p/round-01"});
  EXPECT_EQ(none.exit_code, 1);
  EXPECT_THAT(none.err, HasSubstr("no G-code"));
  ASSERT_EQ(
      run_burin(folder, {"toolpath", "p/round-01/scratches.csv", "--board", "p/board.json", "--bench", "p/bench.json",
                         "--machine", "grbl-spring", "--frame", "--out", "p/round-01/board.gcode"})
          .exit_code,
      0);
  const Outcome check = run_burin(folder, {"check", "carve", "p/round-01", "--machine", "grbl-spring"});
  EXPECT_EQ(check.exit_code, 0) << check.out << check.err;
  EXPECT_THAT(check.out, AllOf(HasSubstr("its table is a guess"), HasSubstr("view d2: "), HasSubstr("13.0 µm deep")));
  const std::string page = file_text(round / "carve-check.html");
  EXPECT_THAT(page, AllOf(HasSubstr("as promised"), HasSubstr("data:image/"), HasSubstr("where the tool first touches"),
                          HasSubstr("sideways")));
  // The same files on a machine that goes to a fixed Z would dig 0.4 mm deep.
  EXPECT_EQ(run_burin(folder, {"check", "carve", "p/round-01", "--machine", "grbl"}).exit_code, 1);
  EXPECT_EQ(run_burin(folder, {"check", "carve", "p/targets"}).exit_code, 1);
  // A round's table stands for the round; one that lies in no project says nothing of its board.
  EXPECT_EQ(run_burin(folder, {"check", "carve", "p/round-01/scratches.csv", "--machine", "grbl-spring"}).exit_code, 0);
  std::filesystem::copy_file(round / "scratches.csv", folder / "scratches.csv");
  EXPECT_EQ(run_burin(folder, {"check", "carve", "scratches.csv"}).exit_code, 2);
}

// The first error of a file, where a person finds it.
TEST(CheckFile, NamesLineAndColumn) {
  const TemporaryFolder folder;
  folder.write("board.json",
               "{\"format\": \"burin/board\", \"version\": 1,\n \"size_mm\": [100, 80],\n \"tags\": "
               "{\"family\": \"tag36h11\",\n  \"list\": [{\"id\": 1, \"sizemm\": 3}]}}");
  const Outcome run = run_burin(folder, {"check", "board.json"});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.err, HasSubstr("board.json:4:12: tags.list[0]")) << run.out;
  std::filesystem::copy_file(places::source() + "/samples/small-bench/board.json", folder / "good.json");
  EXPECT_THAT(run_burin(folder, {"check", "good.json"}).out, HasSubstr("good.json: good: burin/board"));
  const TextPlace place = place_of_field("{\n \"a\": [1, {\"b.\": \"}\", \"c\": 5}]}", "a[1].c");
  EXPECT_EQ(place.line, 2U);
  EXPECT_EQ(place.column, 28U);
}

}  // namespace
}  // namespace burin
