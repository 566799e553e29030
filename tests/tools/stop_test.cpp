// Proves: wherever a command is, a signal ends it with its own exit code and one sentence, nothing half done stays, and
// the same command then ends as if it had never been stopped; kills and second loops do no harm either.
#include <gmock/gmock.h>
#include <signal.h>

#include "burin/base/image.h"
#include "tests/tools/program.h"

namespace burin {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

std::string burin() { return quoted(places::program()); }

// A photograph that takes minutes: of the sample, with many points a pixel.
std::string endless_photo(const TemporaryFolder& folder) {
  std::filesystem::copy(places::source() + "/samples/small-bench", folder / "bench",
                        std::filesystem::copy_options::recursive);
  std::string truth = file_text(folder / "bench" / "truth.json");
  truth.replace(truth.find("\"samples\": 100"), 14, "\"samples\": 40000");
  folder.write("bench/truth.json", truth);
  folder.write("some.csv", "x0_mm,y0_mm,x1_mm,y1_mm\n50,50,54,51\n");
  return burin() + " simulate bench/truth.json --scratches some.csv --out out";
}

// In the shell: `command` is begun, gets a signal once it is at work, and its exit code is said.
std::string stopped(const std::string& command, const std::string& signals, const std::string& before = "") {
  // It listens for SIGTERM (bit 14 of what it catches) once it has begun, which takes long where many tests run at
  // once.
  const std::string begun =
      "while kill -0 $pid && [ $((0x$(sed -n 's/^SigCgt:[[:space:]]*//p' /proc/$pid/status) & 0x4000)) = 0 ]; do sleep "
      "0.05; "
      "done; sleep 0.5; ";
  return before + command + " & pid=$!; " + begun + signals + "; wait $pid; echo exit code $?";
}

class Stop : public ::testing::Test {
 protected:
  Stop() : endless_(endless_photo(folder_)) {}

  Outcome run(const std::string& line) const {
    return run_shell(folder_, "cd " + quoted(folder_.path().string()) + " && { " + line + "; }");
  }
  bool left() const {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_.path()))
      if (entry.path().filename().string().find(".part") != std::string::npos) return true;
    return false;
  }

  TemporaryFolder folder_;
  std::string endless_;
};

TEST_F(Stop, EachSignalHasItsExitCodeAndOneSentence) {
  for (const auto& [name, code] : {std::pair{"INT", "130"}, std::pair{"TERM", "143"}, std::pair{"HUP", "129"}}) {
    const Outcome ended = run(stopped(endless_, std::string("kill -") + name + " $pid"));
    EXPECT_THAT(ended.out, HasSubstr(std::string("exit code ") + code)) << ended.err;
    EXPECT_THAT(ended.err, AllOf(HasSubstr("burin: stopped by "), HasSubstr(name), HasSubstr("burin simulate bench")));
    EXPECT_EQ(std::count(ended.err.begin(), ended.err.end(), '\n'), 1) << ended.err;
    EXPECT_FALSE(left());
  }
}

TEST_F(Stop, IsSaidAsJsonWhereAllIs) {
  std::string json = endless_;
  json.replace(json.find(" simulate"), 9, " --json simulate");
  const Outcome ended = run(stopped(json, "kill -TERM $pid"));
  EXPECT_THAT(ended.out,
              AllOf(HasSubstr("\"exit_code\": 143"), HasSubstr("stopped by SIGTERM"), HasSubstr("exit code 143")));
  EXPECT_EQ(ended.err, "");
}

// nohup: what was ignored from the beginning stays so.
TEST_F(Stop, AHangupThatIsIgnoredStaysIgnored) {
  const Outcome ended = run(
      stopped(endless_, "kill -HUP $pid; sleep 0.3; kill -0 $pid && echo at work; kill -TERM $pid", "trap '' HUP; "));
  EXPECT_THAT(ended.out, AllOf(HasSubstr("at work"), HasSubstr("exit code 143"))) << ended.err;
}

// A design keeps what it has at the first signal; the second one ends it, wherever it is, even in its guided start.
TEST_F(Stop, ASecondSignalEndsAtOnce) {
  const std::string design = burin() + " design bench/design.json --out out --count 200000 --pixels 600";
  const Outcome ended = run(stopped(design, "kill -INT $pid; sleep 0.7; kill -INT $pid 2>/dev/null"));
  EXPECT_THAT(ended.out, HasSubstr("exit code 130")) << ended.err;
  EXPECT_EQ(
      std::count(ended.err.begin(), ended.err.end(), '\n') - (ended.err.find("note: ") != std::string::npos ? 1 : 0), 1)
      << ended.err;
  EXPECT_FALSE(left());
}

// Who is already saying why it failed, to a reader that has not caught up, says that and nothing of the signal.
TEST_F(Stop, ASignalDuringTheLastWordsAddsNone) {
  const Outcome ended =
      run("mkfifo slow && exec 3<>slow && head -c 65536 /dev/zero >&3 && { " + burin() +
          " status nowhere 2>&3 3>&- & pid=$!; sleep 1; kill -INT $pid; sleep 0.5; head -c 65536 <&3 >/dev/null; wait "
          "$pid; echo exit code $?; timeout 1 cat <&3; }");
  EXPECT_THAT(ended.out, AllOf(HasSubstr("exit code 1\n"), HasSubstr("nowhere"), Not(HasSubstr("stopped by"))));
}

// Each signal whose default is to end a process, after which a part file would stay. Faults are none of Burin's making:
// they are sent.
TEST_F(Stop, NoSignalLeavesAnythingBehind) {
  for (const int number : {SIGQUIT, SIGUSR1, SIGUSR2, SIGALRM, SIGVTALRM, SIGPROF, SIGXCPU, SIGPOLL, SIGRTMIN, SIGSEGV,
                           SIGBUS, SIGABRT, SIGFPE, SIGILL}) {
    // The shell lets what it runs in the background ignore SIGQUIT.
    const Outcome ended =
        run(stopped("env --default-signal=QUIT " + endless_, "kill -" + std::to_string(number) + " $pid"));
    const bool is_fault =
        number == SIGSEGV || number == SIGBUS || number == SIGABRT || number == SIGFPE || number == SIGILL;
    EXPECT_THAT(ended.out, HasSubstr("exit code " + std::to_string(128 + number)));
    EXPECT_THAT(ended.err, HasSubstr(is_fault ? "burin: ended by SIG" : "burin: stopped by ")) << number;
    EXPECT_EQ(ended.err.find("fault in Burin") != std::string::npos, is_fault) << ended.err;
    EXPECT_EQ(std::count(ended.err.begin(), ended.err.end(), '\n'), 1) << ended.err;
    EXPECT_FALSE(left()) << number;
  }
}

// A limit on files' sizes and a pipe whose reader has ended are errors of a write, in one sentence.
TEST_F(Stop, WhatCannotBeWrittenEndsInASentence) {
  const Outcome large = run("ulimit -f 8; " + burin() +
                            " view --board bench/board.json --bench bench/bench.json "
                            "--scratches some.csv --out view.html; echo exit code $?");
  EXPECT_THAT(large.out, HasSubstr("exit code 1"));
  EXPECT_THAT(large.err, AllOf(HasSubstr("view.html: could not be written whole: File too large"),
                               HasSubstr("write to a disk that takes files of that size")));
  EXPECT_FALSE(left());
  const Outcome closed = run("{ sleep 1; " + burin() + " design --help; echo exit code $? >&2; } | true");
  EXPECT_THAT(closed.err, HasSubstr("exit code 1\n"));
  EXPECT_THAT(closed.err, HasSubstr("burin: standard output: the text could not be written"));
  for (const char* command : {" status nowhere", " report nowhere", " watch nowhere", " --json status nowhere"}) {
    const Outcome none = run(burin() + command + " <&- >&- 2>&-; echo exit code $?");
    EXPECT_THAT(none.out, HasSubstr("exit code 1\n")) << command;
  }
}

// No thread can be had, or too few: one sentence, never an abort.
TEST_F(Stop, WithoutThreadsASentenceIsSaid) {
  const std::string library = places::binary() + "/tests/libburin_few_threads.so";
  if (!std::filesystem::exists(library)) GTEST_SKIP() << "preloading is not tried beside a sanitizer";
  const std::string few = "LD_PRELOAD=" + quoted(library) + " BURIN_MOST_THREADS=";
  for (const std::string command : {" design bench/design.json --out out --count 50 --pixels 48 --iterations 1",
                                    " status bench", " watch bench --once", " print bench --out tags.pdf",
                                    " --json render bench/board.json --bench bench/bench.json --view d0 --out d0.png"})
    for (int threads = 0; threads < 9; ++threads) {  // libraries begin some while they are loaded
      const Outcome ended = run(few + std::to_string(threads) + " " + burin() + command + "; echo exit code $?");
      const std::string said = ended.out + ended.err;
      if (threads == 0) {
        EXPECT_THAT(ended.out, HasSubstr("exit code 1\n")) << command;
        EXPECT_THAT(said, HasSubstr("raise the limit on processes and threads (ulimit -u)")) << command;
      }
      EXPECT_THAT(ended.out, ::testing::MatchesRegex("(.|\n)*exit code [01]\n")) << command << said;
      EXPECT_THAT(said, Not(HasSubstr("fault in Burin"))) << command;
      EXPECT_FALSE(left()) << command;
    }
}

// The short form of `tests/reliability/stops signals --minutes M`: every command once, at a random moment. Kills of a
// loop, and two at once: tests/tools/loop_mishaps_test.cpp.
TEST(Stops, AtRandomMomentsLoseNothing) {
  const TemporaryFolder folder;
  if (run_shell(folder, "python3 -c ''").exit_code != 0) GTEST_SKIP() << "python3 is not installed";
  const Outcome stops = run_shell(
      folder, "python3 " + quoted(places::source() + "/tests/reliability/stops") + " signals --program " + burin());
  EXPECT_EQ(stops.exit_code, 0) << stops.out << stops.err;
  EXPECT_THAT(stops.out, AllOf(HasSubstr("signal: design"), HasSubstr("signal: refine")));
}

TEST(Simd, IsChosenByOptionOrEnvironmentAndWrittenDown) {
  const TemporaryFolder folder;
  const std::string bench = places::source() + "/samples/small-bench";
  const std::vector<std::string> design{"design", bench + "/design.json", "--count", "100",  "--pixels",
                                        "48",     "--iterations",         "3",       "--out"};
  const auto made_with = [&](std::vector<std::string> before, const std::string& out) {
    before.insert(before.end(), design.begin(), design.end());
    before.push_back(out);
    const Outcome run = run_burin(folder, before);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return file_text(folder / out / "design-report.json");
  };
#if defined(__x86_64__)
  EXPECT_THAT(made_with({"--simd", "sse2"}, "a"), HasSubstr("\"simd\": \"sse2\""));
  const Outcome by_environment =
      run_shell(folder, "cd " + quoted(folder.path().string()) + " && BURIN_SIMD=sse2 " + burin() + " design " +
                            quoted(bench + "/design.json") + " --count 100 --pixels 48 --iterations 3 --out b");
  ASSERT_EQ(by_environment.exit_code, 0) << by_environment.err;
  EXPECT_EQ(file_text(folder / "a" / "scratches.csv"), file_text(folder / "b" / "scratches.csv"));
  EXPECT_THAT(file_text(folder / "b" / "design-report.json"), HasSubstr("\"simd\": \"sse2\""));
#endif
  EXPECT_THAT(made_with({}, "c"), HasSubstr("\"simd\": \""));
  const Outcome wrong = run_burin(folder, {"--simd", "mmx", "status", "."});
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_THAT(wrong.err, HasSubstr("sse2, avx2 or avx512"));
}

}  // namespace
}  // namespace burin
