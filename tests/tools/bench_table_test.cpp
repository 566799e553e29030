// scripts/bench and scripts/bench-table, as a person runs them: benchmarks' JSON into tables, medians with their
// scatter, into a page between its marks; a sentence and no half-written page where that cannot be done. Not proved
// here: that the benchmarks are right.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/places.h"
#include "tests/tools/program.h"

namespace burin {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

// `start` as the benchmark tells it: "/placed:1/bright:1", or nothing where scratches begin anywhere.
std::string design(int gram, int threads, int repetition, double seconds, const std::string& start = "") {
  return "{\"name\": \"n\", \"run_name\": \"PaperDesign/scratches:40000/views:2/gram:" + std::to_string(gram) + start +
         "/threads:" + std::to_string(threads) +
         "\", \"run_type\": \"iteration\", \"repetition_index\": " + std::to_string(repetition) +
         ", \"real_time\": 1, \"cpu_time\": 20, \"s/100\": " + std::to_string(seconds) +
         ", \"pairs\": 1.5e6, \"allocations\": 0, \"loss_ratio\": 0.3, \"image_rms\": 1e-7, \"gradient_rms\": 3e-5}";
}

const char* const kContext =
    R"("context": {"date": "2030-01-02T03:04:05", "num_cpus": 2, "load_avg": [0.5, 0.4, 0.3], "processor": "Abacus 9"})";

std::string measured() {
  return "{" + std::string(kContext) + ", \"benchmarks\": [" + design(0, 1, 0, 4) + "," + design(0, 1, 1, 5) + "," +
         design(0, 1, 2, 4.5) + "," + design(0, 2, 0, 2.25) + "," + design(1, 2, 0, 2.7) + "," +
         design(0, 2, 0, 1.5, "/placed:1/bright:1") +
         R"(, {"run_name": "PaperDesign/other", "run_type": "aggregate", "real_time": 1},)" +
         R"({"run_name": "WholePairs/width:3", "run_type": "iteration", "error_occurred": true}]})";
}

Outcome run_table(const TemporaryFolder& folder, const std::string& arguments) {
  return run_shell(folder, "cd " + quoted(folder.path().string()) + " && " +
                               quoted(places::source() + "/scripts/bench-table") + " " + arguments);
}

TEST(BenchTable, MediansScatterAndRatios) {
  const TemporaryFolder folder;
  folder.write("speed.json", measured());
  const Outcome run = run_table(folder, "speed.json");
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(
      run.out,
      AllOf(HasSubstr("Abacus 9"), HasSubstr("2030-01-02"), HasSubstr("Load average at the start: 0.5"),
            HasSubstr("| 40,000 x 2 | anywhere, all | E_p | 1 | 4.5 (4 to 5) |"),
            HasSubstr("| anywhere, all | E_p + Gram | 2 | 2.7 |"),
            HasSubstr("| placed, what is bright | E_p | 2 | 1.5 |"), HasSubstr("two threads 2.00 times as fast as one"),
            HasSubstr("Gram adds 20 %"), Not(HasSubstr("Whole pairs")), Not(HasSubstr("nan"))));
}

TEST(BenchTable, WritesBetweenTheMarksAgainAndAgain) {
  const TemporaryFolder folder;
  folder.write("speed.json", measured());
  const std::string begin = "<!-- scripts/bench --docs writes from here -->", end = "<!-- to here -->";
  folder.write("page.md", "before\n" + begin + "\nold numbers\n" + end + "\nafter\n");
  std::string first;
  for (int k = 0; k < 2; ++k) {
    const Outcome run = run_table(folder, "speed.json --into page.md");
    EXPECT_EQ(run.exit_code, 0) << run.err;
    const std::string page = file_text(folder / "page.md");
    EXPECT_THAT(page, AllOf(HasSubstr("before\n" + begin), HasSubstr("4.5 (4 to 5)"), HasSubstr(end + "\nafter\n"),
                            Not(HasSubstr("old numbers"))));
    if (k == 0) first = page;
    EXPECT_EQ(page, first);
  }
}

TEST(BenchTable, SaysWhatIsWrong) {
  const TemporaryFolder folder;
  folder.write("speed.json", measured());
  folder.write("cut.json", measured().substr(0, 200));
  folder.write("page.md", "no marks\n");
  Outcome run = run_table(folder, "missing.json");
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.err,
              AllOf(HasSubstr("missing.json"), HasSubstr("scripts/bench --json"), Not(HasSubstr("Traceback"))));
  run = run_table(folder, "cut.json");
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.err, AllOf(HasSubstr("cut.json"), Not(HasSubstr("Traceback"))));
  run = run_table(folder, "speed.json --into page.md");
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.err, HasSubstr("both marks"));
  EXPECT_EQ(file_text(folder / "page.md"), "no marks\n");
  run = run_table(folder, "speed.json --onto page.md");
  EXPECT_EQ(run.exit_code, 2);
}

TEST(Bench, HelpAndWrongOptionsBeforeAnythingIsBuilt) {
  const TemporaryFolder folder;
  const std::string bench = quoted(places::source() + "/scripts/bench");
  Outcome run = run_shell(folder, bench + " --help");
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_THAT(run.out, AllOf(HasSubstr("scripts/bench --docs"), HasSubstr("--json speed.json")));
  run = run_shell(folder, bench + " --jsn out.json");
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, AllOf(HasSubstr("--jsn"), HasSubstr("--help")));
}

}  // namespace
}  // namespace burin
