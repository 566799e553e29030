// The program's door: every command is there, helps with an example, and says by its exit code whether it
// was done (0), could not be done (1) or was asked wrongly (2). What the commands do is proved by other tests.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <sstream>
#include <tuple>

#include "tests/tools/program.h"
#include "tools/commands.h"
#include "tools/old_names.h"

namespace burin {
namespace {

using ::testing::HasSubstr;

class Command : public ::testing::TestWithParam<const char*> {};

TEST_P(Command, HelpsWithAnExample) {
  const TemporaryFolder folder;
  const Outcome run = run_burin(folder, {GetParam(), "--help"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("Example:\n  burin " + std::string(GetParam())));
  EXPECT_EQ(run.err, "");
}

TEST_P(Command, WithoutWhatItNeedsTheCommandLineIsWrong) {
  const TemporaryFolder folder;
  const Outcome run = run_burin(folder, {GetParam()});
  EXPECT_EQ(run.exit_code, 2) << run.out << run.err;
  EXPECT_THAT(run.err, HasSubstr("required"));
  EXPECT_EQ(folder.file_count(), 0U);
}

TEST_P(Command, RefusesAnOptionThatItDoesNotKnow) {
  const TemporaryFolder folder;
  const Outcome run = run_burin(folder, {GetParam(), "--frobnicate"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_EQ(folder.file_count(), 0U);
}

INSTANTIATE_TEST_SUITE_P(Burin, Command,
                         ::testing::Values("simulate", "plan", "capture", "calibrate", "lens", "refine", "design",
                                           "render", "toolpath", "report", "loop", "check"),
                         [](const auto& info) { return std::string(info.param); });

// The oracle is a shell: it reads the word back.
TEST(CommandLine, WordsThatAreToBePastedSurviveAShell) {
  const TemporaryFolder folder;
  for (const std::string word :
       {"bench/session.json", "my bench/session.json", "it's", "a&b;c", "$HOME", "*", "", "x\\y", "\"quoted\""})
    EXPECT_EQ(run_shell(folder, "printf %s " + shell_word(word)).out, word) << shell_word(word);
  EXPECT_EQ(shell_word("bench/session.json"), "bench/session.json") << "no quotes where none are needed";
}

// The command that a run named last, as a person would paste it.
void paste_next(const TemporaryFolder& folder, const std::string& out) {
  const auto at = out.rfind("next: burin ");
  ASSERT_NE(at, std::string::npos) << out;
  const std::string next = out.substr(at + std::string("next: burin ").size());
  const Outcome pasted = run_shell(folder, "cd " + quoted(folder.path().string()) + " && " + quoted(places::program()) +
                                               " " + next.substr(0, next.find('\n')));
  EXPECT_EQ(pasted.exit_code, 0) << next << pasted.err;
}

TEST(CommandLine, TheNextCommandCanBePastedAsItStands) {
  const TemporaryFolder folder;
  std::filesystem::copy(places::source() + "/samples/small-bench", folder / "my bench",
                        std::filesystem::copy_options::recursive);
  folder.write("scratches.csv", "x0_mm,y0_mm,x1_mm,y1_mm\n30,30,34,33\n50,40,52,44\n");
  const Outcome run = run_burin(folder, {"simulate", "my bench/truth.json", "--scratches", "scratches.csv", "--views",
                                         "d0", "d1", "c3", "--samples", "1", "--out", "its photos"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  paste_next(folder, run.out);
  EXPECT_TRUE(std::filesystem::exists(folder / "its photos" / "session.json"));
}

TEST(CommandLine, TheToolPathThatADesignNamesCanBePasted) {
  const TemporaryFolder folder;
  std::filesystem::copy(places::source() + "/samples/small-bench", folder / "my bench",
                        std::filesystem::copy_options::recursive);
  const Outcome run = run_burin(folder, {"design", "my bench/design.json", "--count", "40", "--pixels", "32",
                                         "--iterations", "1", "--out", "its design"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  paste_next(folder, run.out);
  EXPECT_TRUE(std::filesystem::exists(folder / "its design" / "board.gcode"));
}

TEST(CommandLine, QuietSaysNotesAndErrorsOnly) {
  const TemporaryFolder folder;
  // Of no project: nothing is known of the bench.
  std::filesystem::copy_file(places::source() + "/samples/small-bench/board.json", folder / "board.json");
  const std::string board = (folder / "board.json").string();
  const Outcome done = run_burin(folder, {"--quiet", "plan", board, "--shots", "1", "--out", "plan"});
  EXPECT_EQ(done.exit_code, 0);
  EXPECT_EQ(done.out, "");
  EXPECT_THAT(done.err, HasSubstr("note: no --bench"));
  EXPECT_TRUE(std::filesystem::exists(folder / "plan" / "plan.json"));
  const Outcome not_done = run_burin(folder, {"--quiet", "plan", "none.json"});
  EXPECT_EQ(not_done.exit_code, 1);
  EXPECT_THAT(not_done.err, HasSubstr("burin: none.json"));
}

TEST(CommandLine, JsonSaysAllInOneObject) {
  const TemporaryFolder folder;
  // Of no project: nothing is known of the bench.
  std::filesystem::copy_file(places::source() + "/samples/small-bench/board.json", folder / "board.json");
  const std::string board = (folder / "board.json").string();
  const Outcome done = run_burin(folder, {"--threads", "1", "--json", "plan", board, "--shots", "1"});
  EXPECT_EQ(done.exit_code, 0);
  EXPECT_EQ(done.err, "");
  const auto said = nlohmann::json::parse(done.out);
  EXPECT_EQ(said["command"], "plan");
  EXPECT_EQ(said["exit_code"], 0);
  ASSERT_EQ(said["diagnostics"].size(), 2U) << said;
  for (const auto& diagnostic : said["diagnostics"]) EXPECT_EQ(diagnostic["severity"], "note");
  EXPECT_EQ(said["data"]["shots"].size(), 1U) << said;
  EXPECT_EQ(said["data"]["parameters"][0]["goal"].count("unit"), 1U) << said;
  EXPECT_TRUE(said["next"].empty()) << "a folder of photos is for a person to name";
  const Outcome not_done = run_burin(folder, {"--json", "plan", "none.json"});
  EXPECT_EQ(not_done.exit_code, 1);
  const auto failed = nlohmann::json::parse(not_done.out);
  EXPECT_EQ(failed["exit_code"], 1);
  EXPECT_EQ(failed["diagnostics"].back()["code"], "missing-file") << failed;
  EXPECT_EQ(failed["diagnostics"].back()["file"], "none.json");
  const auto wrong = nlohmann::json::parse(run_burin(folder, {"--json", "plan", "--frobnicate"}).out);
  EXPECT_EQ(wrong["exit_code"], 2);
  EXPECT_EQ(wrong["diagnostics"][0]["code"], "command-line");
  folder.write("bad.json", R"({"format": "burin/board", "version": 1, "size_mm": [100]})");
  const auto bad = nlohmann::json::parse(run_burin(folder, {"--json", "print", "bad.json"}).out);
  EXPECT_EQ(bad["diagnostics"][0]["code"], "bad-key") << bad;
  EXPECT_EQ(bad["diagnostics"][0]["file"], "bad.json");
  EXPECT_EQ(bad["diagnostics"][0]["field"], "size_mm");
}

// Each line is an object of its own, and the last one is that of --json.
TEST(CommandLine, JsonLinesTellProgressAndEndWithTheResult) {
  const TemporaryFolder folder;
  std::filesystem::copy_file(places::source() + "/samples/small-bench/board.json", folder / "board.json");
  const std::vector<std::string> plan{"plan", "board.json", "--shots", "1", "--threads", "1"};
  const auto with = [&](std::vector<std::string> words) {
    words.insert(words.end(), plan.begin(), plan.end());
    return run_burin(folder, words).out;
  };
  std::istringstream lines(with({"--json-lines"}));
  std::vector<std::string> events;
  nlohmann::json last;
  for (std::string line; std::getline(lines, line);) {
    last = nlohmann::json::parse(line);
    events.push_back(last["event"]);
  }
  EXPECT_THAT(events, ::testing::IsSupersetOf({"diagnostic", "progress"}));
  EXPECT_EQ(events.back(), "result");
  last.erase("event");
  EXPECT_EQ(last, nlohmann::json::parse(with({"--json"})));
}

// What the text says is in the data, with its unit and sigma: both come from one statement.
TEST(CommandLine, TextAndDataSayTheSame) {
  Report report;
  report.in("lens").line("focal {:.1f} px, +- {:.2f}\n", fact("focal", 3000.25, "px", 0.5), 0.5);
  report.add("views").line("{:<4}|\n", fact("view", std::string("d0")));
  report.add("views").set("view", "d1");
  EXPECT_EQ(report.text, "focal 3000.2 px, +- 0.50\nd0  |\n");
  EXPECT_EQ(report.data, nlohmann::ordered_json::parse(R"({
    "lens": {"focal": {"value": 3000.25, "unit": "px", "sigma": 0.5}}, "views": [{"view": "d0"}, {"view": "d1"}]})"));
}

// docs/json.md lists each code of the program, and no other, and so does the schema.
TEST(CommandLine, TheCodesOfErrorsAreListed) {
  std::string table;
  for (const ErrorCodeText& code : error_codes()) {
    EXPECT_STREQ(name_of(code.code), code.name);
    table += "| `" + std::string(code.name) + "` | " + code.meaning + " |\n";
  }
  const std::string page = file_text(places::source() + "/docs/json.md"), head = "| code | meaning |\n| --- | --- |\n";
  EXPECT_THAT(page, HasSubstr(head + table + "\n"));
  std::set<std::string> names;
  for (const ErrorCodeText& code : error_codes()) names.insert(code.name);
  table.clear();
  for (const FindingCodeText& code : finding_codes()) {
    EXPECT_STREQ(name_of(code.code), code.name);
    table += "| `" + std::string(code.name) + "` | " + code.meaning + " |\n";
    EXPECT_TRUE(names.insert(code.name).second) << code.name << " is an error's code as well";
  }
  EXPECT_THAT(page, ::testing::EndsWith(head + table));
  const auto schema = nlohmann::json::parse(file_text(places::source() + "/docs/schema/result.schema.json"));
  EXPECT_EQ(schema["$defs"]["diagnostic"]["properties"]["code"]["enum"], nlohmann::json(names));
}

TEST(CommandLine, OldNamesOfOptionsWorkWithANote) {
  const TemporaryFolder folder;
  std::filesystem::copy_file(places::source() + "/samples/small-bench/board.json", folder / "board.json");
  const Outcome old = run_burin(folder, {"plan", "board.json", "--shots", "1", "--focus-mm", "900"});
  EXPECT_EQ(old.exit_code, 0) << old.err;
  EXPECT_THAT(old.err, HasSubstr("note: --focus-mm is called --focus now"));
  const Outcome now = run_burin(folder, {"plan", "board.json", "--shots", "1", "--focus", "90cm"});
  EXPECT_EQ(now.out, old.out);
  EXPECT_THAT(now.err, ::testing::Not(HasSubstr("called")));
  std::vector<std::string> words{"loop", "p", "--free-width", "--carve-hours", "6", "--carve-hours=6h30min"};
  replace_old_names("loop", 0, words);
  EXPECT_EQ(words,
            (std::vector<std::string>{"loop", "p", "--free=width", "--carve-time", "6h", "--carve-time=6h30min"}));
}

TEST(CommandLine, JsonNamesTheFilesThatWereWritten) {
  const TemporaryFolder folder;
  folder.write("board.json", R"({"format": "burin/board", "version": 1, "size_mm": [100, 80]})");
  folder.write("scratches.csv", "x0_mm,y0_mm,x1_mm,y1_mm\n10,10,14,12\n90,70,85,70\n");
  const std::vector<std::string> command{"--json",  "toolpath", "scratches.csv", "--board", "board.json",
                                         "--frame", "--out",    "out.gcode",     "--sent",  "sent.csv"};
  const auto made = nlohmann::json::parse(run_burin(folder, command).out);
  EXPECT_EQ(made["files"], (nlohmann::json{"out-frame.gcode", "out.gcode", "sent.csv"})) << made;
  // Made beside its place, and moved there as a whole.
  std::filesystem::copy_file(places::source() + "/tests/data/targets/camera.png", folder / "camera.png");
  const auto project = nlohmann::json::parse(
      run_burin(folder, {"new", "n", "--board", "120x100", "--pictures", "camera.png", "--count", "60", "--json"}).out);
  std::set<std::string> named, there;
  for (const auto& file : project["files"]) named.insert(file.get<std::string>());
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder / "n"))
    if (entry.is_regular_file()) there.insert(entry.path().string());
  EXPECT_EQ(named, there);
  EXPECT_EQ(nlohmann::json::parse(
                run_burin(folder, {"--json", "toolpath", "none.csv", "--board", "board.json", "--out", "x.gcode"})
                    .out)["files"],
            nlohmann::json::array());
}

TEST(CommandLine, VersionAndHelpAreDone) {
  const TemporaryFolder folder;
  EXPECT_THAT(run_burin(folder, {"--version"}).out,
              ::testing::MatchesRegex("burin [0-9]+\\.[0-9]+\\.[0-9]+(-dev\\.[0-9]+\\+g[0-9a-f]+(\\.dirty)?)?\n"));
  const Outcome help = run_burin(folder, {"--help"});
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_THAT(help.out, HasSubstr("calibrate"));
}

// NO_COLOR (no-color.org) is kept at a terminal, too, and without the variable there is no color either:
// docs/README.md.
TEST(CommandLine, NothingIsPrintedInColor) {
  const TemporaryFolder folder;
  for (const char* words : {"--help", "design none.json --out d", "desing"})
    for (const char* setting : {"NO_COLOR=1", "TERM=xterm-256color"}) {
      const std::string line = "cd " + quoted(folder.path().string()) + "; " + setting + " script -qec " +
                               quoted(quoted(places::program()) + " " + words) + " typescript >/dev/null </dev/null";
      std::ignore = std::system(line.c_str());
      const std::string shown = file_text(folder / "typescript");
      EXPECT_GT(shown.size(), 100U) << line;
      EXPECT_THAT(shown, ::testing::Not(::testing::ContainsRegex("\x1b\\[[0-9;]*m"))) << line;
    }
}

TEST(CommandLine, MachinesOfTheLoopMayBeToml) {
  const TemporaryFolder folder;
  EXPECT_THAT(run_burin(folder, {"loop", "--help"}).out, HasSubstr("TOML"));
}

TEST(CommandLine, AnUnknownCommandIsNamed) {
  const TemporaryFolder folder;
  const Outcome run = run_burin(folder, {"etch"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, HasSubstr("etch"));
}

}  // namespace
}  // namespace burin
