// Proves: a command in a project takes the project's machine, board and bench and says so, from any working directory,
// by relative and absolute paths and through links; what is said goes before it; outside of a project nothing is
// guessed; and the loop's own page is neither replaced by a verdict under other settings, nor is a person blamed for
// what Burin wrote.
#include "tools/project_settings.h"

#include <gmock/gmock.h>

#include <filesystem>
#include <regex>
#include <string>
#include <vector>

#include "burin/scene/scratches.h"
#include "tests/tools/loop_bench.h"
#include "tests/tools/program.h"

namespace burin {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

// A page without the minute in which it was written.
std::string page_text(const fs::path& page) {
  return std::regex_replace(file_text(page), std::regex("on \\d{4}-\\d\\d-\\d\\d \\d\\d:\\d\\d"), "");
}

// A round that is designed for a machine that is not the usual one.
struct SpringProject {
  TemporaryFolder folder;
  fs::path project = folder / "project", round = project / "round-01";

  SpringProject() { make_tiny_project(folder, {"d0", "d1"}, 0.5); }
  void design() const {
    const Outcome made = run_burin(folder, {"loop", "project", "--machine", "grbl-spring", "--iterations", "4",
                                            "--pixels", "64", "--count", "200"});
    ASSERT_EQ(made.exit_code, 0) << made.out << made.err;
  }
  Outcome in(const std::string& directory, const std::vector<std::string>& words) const {
    std::string line = "cd " + quoted((folder / directory).string()) + " && " + quoted(places::program());
    for (const std::string& word : words) line += " " + quoted(word);
    return run_shell(folder, line);
  }
};

TEST(ProjectSettings, TheRoundOfAPathIsFound) {
  const SpringProject p;
  fs::create_directories(p.round / "design");
  fs::create_directory_symlink(p.round, p.folder / "link");
  for (const fs::path& path : {p.round, p.round / "design", p.round / "none.csv", p.folder / "link", p.round / ""}) {
    const auto at = project_of(path);
    ASSERT_TRUE(at) << path;
    EXPECT_TRUE(fs::equivalent(at->project.folder, p.project)) << path;
    EXPECT_EQ(at->round, 1) << path;
  }
  EXPECT_EQ(project_of(p.project)->round, 0);
  EXPECT_EQ(project_of(p.project / "targets")->round, 0);
  EXPECT_FALSE(project_of(p.folder.path()));
  // A round holds the same files as a project, and is none.
  for (const char* file : {"board.json", "design.json", "bench.json"}) fs::copy_file(p.project / file, p.round / file);
  EXPECT_TRUE(fs::equivalent(project_of(p.round)->project.folder, p.project));
  EXPECT_EQ(project_folder(p.round, "X"), p.project);
  EXPECT_EQ(project_folder(p.project, "X"), p.project);
  EXPECT_EQ(project_folder(p.project / "targets", "X"), p.project / "targets")
      << "a folder that is no round is what it is";
}

TEST(ProjectSettings, CheckTakesTheMachineOfTheProject) {
  const SpringProject p;
  p.design();
  if (HasFatalFailure()) return;
  const fs::path page = p.round / "carve-check.html";
  const std::string by_loop = page_text(page);
  ASSERT_THAT(by_loop, HasSubstr("No error."));
  fs::create_directories(p.folder / "elsewhere");
  fs::create_directory_symlink(p.round, p.folder / "elsewhere" / "link");
  for (const auto& [directory, what] : {std::pair<std::string, std::string>{".", "project/round-01"},
                                        {"project", "round-01"},
                                        {"project", "round-01/"},
                                        {"project", "."},
                                        {".", p.round.string()},
                                        {"elsewhere", "link"},
                                        {"elsewhere", "../project"},
                                        {"project/round-01", "."},
                                        {"project/round-01", "scratches.csv"},
                                        {"project", "round-01/board.gcode"}}) {
    const Outcome check = p.in(directory, {"check", "carve", what});
    EXPECT_EQ(check.exit_code, 0) << directory << " " << what << check.out << check.err;
    EXPECT_THAT(check.err, AllOf(HasSubstr("from the project"), HasSubstr("machine grbl-spring"))) << what;
    EXPECT_EQ(page_text(page), by_loop) << directory << " " << what;
  }
  EXPECT_THAT(p.in(".", {"status", "project"}).out, Not(HasSubstr("out of date")));
  const Outcome none = p.in("project", {"check", "carve", "round-07"});
  EXPECT_EQ(none.exit_code, 1);
  EXPECT_THAT(none.err, HasSubstr("round-07: does not exist"));
  // Another machine would dig, and its verdict stands beside the loop's.
  const Outcome other = p.in("project", {"check", "carve", "round-01", "--machine", "grbl"});
  EXPECT_EQ(other.exit_code, 1);
  EXPECT_THAT(other.err, AllOf(HasSubstr("carve-check-otherwise.html"), HasSubstr("machine grbl-spring")));
  EXPECT_EQ(page_text(page), by_loop);
  EXPECT_THAT(p.in("project", {"status"}).out, Not(HasSubstr("out of date")));
  // What changed since is looked at again, and is the loop's page then.
  fs::remove(p.round / "board-frame.gcode");
  EXPECT_EQ(p.in("project", {"check", "carve", "round-01"}).exit_code, 0);
  EXPECT_NE(page_text(page), by_loop);
  EXPECT_THAT(p.in("project", {"status"}).out, Not(HasSubstr("carve-check.html was")));
}

TEST(ProjectSettings, ToolPathProbeAndCouponAreForTheMachineOfTheProject) {
  const SpringProject p;
  p.design();
  if (HasFatalFailure()) return;
  const std::string by_loop = file_text(p.round / "board.gcode");
  const Outcome path = p.in("project", {"toolpath", "round-01/scratches.csv", "--out", "again.gcode"});
  ASSERT_EQ(path.exit_code, 0) << path.err;
  EXPECT_THAT(path.err,
              AllOf(HasSubstr("machine grbl-spring"), HasSubstr("board board.json"), HasSubstr("bench bench.json")));
  EXPECT_EQ(file_text(p.project / "again.gcode"), by_loop);
  // Said: nothing is taken, and nothing is said.
  const Outcome said = p.in("project", {"toolpath", "round-01/scratches.csv", "--board", "board.json", "--bench",
                                        "bench.json", "--machine", "linuxcnc", "--out", "said.ngc"});
  ASSERT_EQ(said.exit_code, 0) << said.err;
  EXPECT_THAT(said.err, Not(HasSubstr("from the project")));
  p.folder.write("project/loop.toml", "format = \"burin/loop\"\nversion = 1\nmachine = \"marlin\"\n");
  const Outcome probe = p.in("project", {"probe", "write", ".", "--out", "probe.gcode"});
  EXPECT_THAT(probe.err, HasSubstr("machine marlin")) << probe.out;
  const Outcome coupon = p.in("project", {"coupon", "write", "--number", "2", "--out", "coupon-2"});
  EXPECT_THAT(coupon.err, HasSubstr("machine marlin")) << coupon.out;
  // Outside: asked for, not guessed.
  fs::copy_file(p.round / "scratches.csv", p.folder / "scratches.csv");
  EXPECT_EQ(p.in(".", {"toolpath", "scratches.csv", "--out", "a.gcode"}).exit_code, 2);
}

TEST(ProjectSettings, ViewsAndPlansAreOfTheProjectThatOneIsIn) {
  const SpringProject p;
  p.design();
  if (HasFatalFailure()) return;
  EXPECT_EQ(p.in("project/round-01", {"status"}).exit_code, 0);
  EXPECT_EQ(p.in(".", {"status"}).exit_code, 2) << "no project, and none is guessed";
  const Outcome picture = p.in("project", {"render", "round-01", "--view", "d0", "--out", "d0.png"});
  EXPECT_EQ(picture.exit_code, 0) << picture.err;
  EXPECT_THAT(picture.out, HasSubstr(std::to_string(read_scratches(p.round / "scratches.csv").size()) + " scratches"));
  EXPECT_EQ(p.in("project", {"view", "round-01", "--out", "v.html"}).exit_code, 0);
  EXPECT_EQ(p.in("project", {"print", "--out", "tags.pdf"}).exit_code, 0);
  // The sheet's photos are the plan's, and watch knows them.
  const Outcome sheet = p.in("project/round-01", {"sheet", "--shots", "2"});
  ASSERT_EQ(sheet.exit_code, 0) << sheet.err;
  ASSERT_TRUE(fs::exists(p.project / "plan.json"));
  const auto plan = read_json_file(p.project / "plan.json");
  EXPECT_EQ(plan["shots"].size(), 4U);
  EXPECT_THAT(p.in("project", {"status"}).out, Not(HasSubstr("again")));
  // Other scratches: the photos were planned for those of before.
  ASSERT_EQ(p.in(".", {"loop", "project", "--count", "210"}).exit_code, 1);
  ASSERT_EQ(p.in(".", {"loop", "project", "--force", "design"}).exit_code, 0);
  EXPECT_THAT(p.in("project", {"status"}).out, AllOf(HasSubstr("burin sheet"), HasSubstr("again: the scratches")));
}

TEST(ProjectSettings, ProgramsOptionsStandBehindTheCommandToo) {
  const SpringProject p;
  const Outcome json = p.in("project", {"print", "--json", "--out", "tags.pdf", "--threads", "1"});
  EXPECT_EQ(json.exit_code, 0) << json.err;
  EXPECT_EQ(nlohmann::json::parse(json.out)["command"], "print");
  EXPECT_EQ(p.in("project", {"print", "--out", "tags.pdf", "--threads", "0"}).exit_code, 2);
  const std::string status = p.in("project", {"status", "--json"}).out;
  EXPECT_EQ(nlohmann::json::parse(status)["data"]["stages"].size(), 1U) << status;
  EXPECT_EQ(p.in("project", {"--json", "status"}).out, status) << "on either side";
  EXPECT_EQ(nlohmann::json::parse(p.in(".", {"--json", "status", "none"}).out)["exit_code"], 1);
  EXPECT_EQ(nlohmann::json::parse(p.in("project", {"check", "--json", "ndf", "none.csv"}).out)["command"], "check");
  // A stream of lines, also from before the command.
  const std::string told = p.in("project", {"--json", "watch", "--photos", "targets", "--once"}).out;
  EXPECT_EQ(nlohmann::json::parse(told.substr(0, told.find('\n')))["event"], "began") << told;
}

// How far the machine goes is asked once, and kept with the project; "unknown" is an answer.
TEST(ProjectSettings, TheReachOfTheMachineIsAskedForOnce) {
  const SpringProject p;
  p.design();
  if (HasFatalFailure()) return;
  const std::vector<std::string> toolpath{"toolpath", "round-01/scratches.csv", "--out", "mine.gcode"};
  const auto asks = HasSubstr("the travel of grbl-spring is unknown");
  EXPECT_THAT(p.in("project", toolpath).err, asks);
  ASSERT_EQ(p.in(".", {"loop", "project", "--travel", "unknown"}).exit_code, 0);
  EXPECT_THAT(file_text(p.project / "loop.toml"), HasSubstr("travel_mm = \"unknown\""));
  for (const std::vector<std::string>& command :
       {toolpath, {"check", "carve", "round-01"}, {"probe", "write", ".", "--out", "probe.gcode"}}) {
    const Outcome quiet = p.in("project", command);
    EXPECT_EQ(quiet.exit_code, 0) << quiet.err;
    EXPECT_THAT(quiet.err, Not(asks)) << command[0];
  }
  EXPECT_THAT(p.in("project", {"toolpath", "round-01/scratches.csv", "--machine", "grbl", "--out", "other.gcode"}).err,
              HasSubstr("the travel of grbl is unknown"))
      << "another machine";
  EXPECT_THAT(p.in("project", {"status"}).out, Not(HasSubstr("out of date"))) << "no design rests on it";
  // What is too far is refused from then on, and the tool path that is there as well.
  const Outcome there = p.in(".", {"loop", "project", "--travel", "3x3cm"});
  EXPECT_EQ(there.exit_code, 1);
  EXPECT_THAT(there.err, HasSubstr("do not carve this"));
  EXPECT_THAT(file_text(p.project / "loop.toml"), HasSubstr("travel_mm = [[0, 0], [30, 30]]"));
  const Outcome far = p.in("project", toolpath);
  EXPECT_EQ(far.exit_code, 1);
  EXPECT_THAT(far.err, HasSubstr("travel_mm"));
  EXPECT_EQ(p.in(".", {"loop", "project", "--travel", "far"}).exit_code, 1);
}

TEST(ProjectSettings, ALoopAtATerminalAsksForTheReach) {
  const SpringProject p;
  p.design();
  if (HasFatalFailure()) return;
  if (run_shell(p.folder, "script -qec true /dev/null").exit_code != 0) GTEST_SKIP() << "script is not installed";
  const std::string line = "cd " + quoted(p.folder.path().string()) + " && printf '%s\\n' far 300x180 | script -qec " +
                           quoted(quoted(places::program()) + " loop project") + " /dev/null";
  EXPECT_THAT(run_shell(p.folder, line).out, HasSubstr("How far does grbl-spring go"));
  EXPECT_THAT(file_text(p.project / "loop.toml"), HasSubstr("travel_mm = [[0, 0], [300, 180]]"));
  EXPECT_THAT(run_shell(p.folder, line).out, Not(HasSubstr("How far does"))) << "once";
}

// A round's G-code is held against what it was made from, by its record.
TEST(ProjectSettings, AHeightMapThatCameLaterMakesTheRoundsCheckAnError) {
  const SpringProject p;
  p.design();
  if (HasFatalFailure()) return;
  EXPECT_EQ(p.in("project", {"check", "carve", "round-01"}).exit_code, 0);
  p.folder.write("project/round-01/heights.json",
                 R"({"format": "burin/heights", "version": 1, "zero_mm": [0, 0], "first_mm": [0, 0],
                     "step_mm": [60, 60], "z_mm": [[0, 0, 0], [0, 0, 0], [0, 0, 0]]})");
  const Outcome wrong = p.in("project", {"check", "carve", "round-01"});
  EXPECT_EQ(wrong.exit_code, 1);
  EXPECT_THAT(wrong.out, HasSubstr("board.gcode: was written before round-01/heights.json is new"));
}

TEST(ProjectSettings, ADesignNamesAKeepOutWhoseHeightIsNotKnown) {
  const SpringProject p;
  auto board = read_json_file(p.project / "board.json");
  board["keep_out"] = {{{"name", "clamp"}, {"center_mm", {60, 60}}, {"radius_mm", 3}}};
  p.folder.write("project/board.json", board.dump());
  const std::vector<std::string> design{"design", "project/design.json", "--out", "d", "--count", "50", "--pixels",
                                        "48",     "--iterations",        "1"};
  EXPECT_THAT(p.in(".", design).err,
              AllOf(HasSubstr("board.json"), HasSubstr("the height of the keep-out clamp is unknown"),
                    HasSubstr("\"height_mm\"")));
  board["keep_out"][0]["height_mm"] = 0;
  p.folder.write("project/board.json", board.dump());
  EXPECT_THAT(p.in(".", design).err, Not(HasSubstr("how high")));
}

}  // namespace
}  // namespace burin
