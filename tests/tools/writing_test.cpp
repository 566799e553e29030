// What commands write, through the program itself: nothing that is no file is replaced, links and permissions stay, a
// full disk behind standard output is an error, two commands do not work in one folder, and views in any script get
// files of their own. Failing file operations, one by one, are tests/reliability/faults' affair.
#include <gmock/gmock.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <nlohmann/json.hpp>

#include "tests/tools/program.h"

namespace burin {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

const fs::path kSampleFolder = fs::path(places::source()) / "samples" / "small-bench";

class Writing : public ::testing::Test {
 protected:
  Writing() {
    fs::copy(kSampleFolder, folder / "p", fs::copy_options::recursive);
    folder.write("s.csv", "x0_mm,y0_mm,x1_mm,y1_mm\n30,30,34,33\n40,30,44,33\n");
  }
  Outcome toolpath(const std::string& out, const std::string& more = "") const {
    return run_shell(folder, "cd " + quoted(folder.path().string()) + " && " + quoted(places::program()) +
                                 " toolpath s.csv --board p/board.json --out " + quoted(out) + more);
  }
  TemporaryFolder folder;
};

TEST_F(Writing, WhatIsNoFileStaysWhatItIs) {
  ASSERT_EQ(::mkfifo((folder / "fifo.gcode").c_str(), 0600), 0);
  fs::create_symlink("/dev/null", folder / "null.gcode");
  for (const char* out : {"fifo.gcode", "null.gcode"}) {
    const Outcome run = toolpath(out);
    EXPECT_EQ(run.exit_code, 1) << out;
    EXPECT_THAT(run.err, AllOf(HasSubstr(out), HasSubstr("; "), Not(HasSubstr("fault in Burin"))));
  }
  EXPECT_TRUE(fs::is_fifo(folder / "fifo.gcode"));
  EXPECT_TRUE(fs::is_symlink(folder / "null.gcode") && fs::is_character_file("/dev/null"));
}

TEST_F(Writing, ALinkStaysAndAFileAsPrivateAsItWas) {
  fs::create_directory(folder / "stick");
  folder.write("stick/board.gcode", "old");
  fs::permissions(folder / "stick/board.gcode", fs::perms(0600));
  fs::create_symlink("stick/board.gcode", folder / "board.gcode");
  ASSERT_EQ(toolpath("board.gcode").exit_code, 0);
  EXPECT_TRUE(fs::is_symlink(folder / "board.gcode"));
  EXPECT_THAT(file_text(folder / "stick/board.gcode"), HasSubstr("Burin"));
  EXPECT_EQ(fs::status(folder / "stick/board.gcode").permissions(), fs::perms(0600));
}

// A stranger's project holds links where Burin writes.
TEST_F(Writing, AStrangersLinkLeadsNothingOutOfItsFolder) {
  fs::create_directory(folder / "home");
  folder.write("home/.bashrc", "mine");
  fs::create_symlink("../home/.bashrc", folder / "p/board-frame.gcode");
  const Outcome framed = toolpath("p/board.gcode", " --frame");
  EXPECT_EQ(framed.exit_code, 1);
  EXPECT_THAT(framed.err, AllOf(HasSubstr("p/board-frame.gcode"), HasSubstr("no part of an earlier board.gcode")));
  EXPECT_EQ(file_text(folder / "home/.bashrc"), "mine");
  EXPECT_FALSE(fs::exists(folder / "p/board.gcode")) << "all of it, or nothing";
  fs::create_symlink("../home/.bashrc", folder / "p/carve-check.html");
  const Outcome checked =
      run_shell(folder, "cd " + quoted((folder / "p").string()) + " && " + quoted(places::program()) +
                            " toolpath ../s.csv --board board.json --out b.gcode && " + quoted(places::program()) +
                            " check carve ../s.csv --board board.json --gcode b.gcode");
  EXPECT_EQ(checked.exit_code, 1);
  EXPECT_THAT(checked.err, AllOf(HasSubstr("carve-check.html"), HasSubstr("home/.bashrc")));
  EXPECT_EQ(file_text(folder / "home/.bashrc"), "mine");
  fs::create_directory_symlink("../home", folder / "p/round-01");
  const Outcome loop = run_burin(folder, {"loop", "p"});
  EXPECT_EQ(loop.exit_code, 1);
  EXPECT_THAT(loop.err, AllOf(HasSubstr("the symbolic link "), HasSubstr("p/round-01"), HasSubstr("home")));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder / "home"), fs::directory_iterator()), 1);
  // Who names the file means it.
  EXPECT_EQ(toolpath("p/board-frame.gcode").exit_code, 0);
  EXPECT_THAT(file_text(folder / "home/.bashrc"), HasSubstr("Burin"));
}

TEST_F(Writing, AFullDiskBehindStandardOutputIsAnError) {
  for (const char* redirection : {" >/dev/full", " >&-"}) {
    const Outcome run = toolpath("a.gcode", redirection);
    EXPECT_EQ(run.exit_code, 1) << redirection;
    EXPECT_THAT(run.err, HasSubstr("burin: standard output: ")) << redirection;
  }
  EXPECT_THAT(file_text(folder / "a.gcode"), HasSubstr("Burin")) << "what was made is there, and whole";
}

TEST_F(Writing, EverydayErrorsAreSentences) {
  fs::create_symlink("round", folder / "round");
  const std::string long_name = std::string(300, 'a') + ".gcode";
  for (const std::string& out : {std::string("round/a.gcode"), long_name, std::string("s.csv/a.gcode")}) {
    const Outcome run = toolpath(out);
    EXPECT_EQ(run.exit_code, 1) << out;
    EXPECT_THAT(run.err, AllOf(HasSubstr("; "), Not(HasSubstr("fault in Burin")), Not(HasSubstr("filesystem error"))));
  }
  const Outcome status = run_burin(folder, {"status", "round"});
  EXPECT_EQ(status.exit_code, 1);
  EXPECT_THAT(status.err, AllOf(HasSubstr("symbolic links"), Not(HasSubstr("fault in Burin"))));
}

TEST_F(Writing, OneCommandAtATimeInAFolderOfResults) {
  const std::vector<std::string> design{"design", "p/design.json", "--out", "p/round-01/design", "--iterations",
                                        "1",      "--pixels",      "48",    "--scratches",       "30"};
  fs::create_directories(folder / "p/round-01");
  const int file = ::open((folder / "p/.burin-lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  ASSERT_EQ(::flock(file, LOCK_EX), 0);
  ASSERT_GT(::write(file, "burin refine, process 4711 since 2025-06-01\n", 44), 0);
  const Outcome second = run_burin(folder, design);
  EXPECT_EQ(second.exit_code, 1);
  EXPECT_THAT(second.err, HasSubstr("burin refine, process 4711 since 2025-06-01"));
  EXPECT_FALSE(fs::exists(folder / "p/round-01/design/scratches.csv"));
  fs::copy_file(folder / "p/design.json", folder / "p/round-01/design.json");
  folder.write("p/round-01/scratches.csv", "x0_mm,y0_mm,x1_mm,y1_mm\n30,30,35,33\n");
  const std::vector<std::vector<std::string>> others{
      {"plan", "p", "--out", "p/round-01/plan"},
      {"sheet", "p"},
      {"view", "p"},
      {"check", "carve", "p/round-01"},
      {"lens", "p", "--chessboard", "9x6", "--square", "25", "--out", "p/round-01/lens.cameramodel"},
      {"coupon", "write", "--machine", "grbl-spring", "--out", "p/round-01/coupon"}};
  for (const std::vector<std::string>& command : others) {
    const Outcome other = run_burin(folder, command);
    EXPECT_EQ(other.exit_code, 1) << command.front();
    EXPECT_THAT(other.err, HasSubstr("burin refine, process 4711")) << command.front();
  }
  EXPECT_FALSE(fs::exists(folder / "p/round-01/plan") || fs::exists(folder / "p/round-01/coupon"));
  EXPECT_EQ(toolpath("a.gcode").exit_code, 0) << "elsewhere anybody may work";
  ::close(file);
  EXPECT_EQ(run_burin(folder, design).exit_code, 0);
  EXPECT_FALSE(fs::exists(folder / "p/.burin-lock")) << "goes with its command";
}

TEST_F(Writing, ViewsInAnyScriptHaveFilesOfTheirOwn) {
  std::string bench = file_text(folder / "p/bench.json"), spec = file_text(folder / "p/design.json");
  const auto replace = [](std::string& text, const std::string& from, const std::string& to) {
    for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
      text.replace(at, from.size(), to);
  };
  replace(bench, "\"d0\"", "\"左\""), replace(bench, "\"d1\"", "\"右\"");
  replace(spec, "\"d0\"", "\"左\""), replace(spec, "\"d1\"", "\"右\"");
  folder.write("p/bench.json", bench);
  folder.write("p/design.json", spec);
  ASSERT_EQ(run_burin(folder,
                      {"design", "p/design.json", "--out", "d", "--iterations", "1", "--pixels", "48", "--count", "30"})
                .exit_code,
            0);
  EXPECT_TRUE(fs::exists(folder / "d/preview-左.png") && fs::exists(folder / "d/preview-右.png"));
  const Json report = Json::parse(file_text(folder / "d/design-report.json"));
  for (const Json& view : report["views"])
    EXPECT_TRUE(fs::exists(folder / "d" / view["preview"].get<std::string>())) << view["view"];
}

}  // namespace
}  // namespace burin
