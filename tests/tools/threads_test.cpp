// Proves: `burin --threads N COMMAND` holds for the whole of a command, makes the same file for any N, and refuses less
// than one.
#include <gmock/gmock.h>

#include <algorithm>
#include <atomic>
#include <thread>

#include "burin/base/image.h"
#include "burin/base/threads.h"
#include "burin/pictures/picture.h"
#include "tests/tools/program.h"
#include "tools/command_line.h"

namespace burin {
namespace {

using ::testing::HasSubstr;

/// The smallest number of threads that was allowed while a command ran in this process.
int least_threads_during(const std::vector<std::string>& arguments) {
  std::atomic<bool> watching{false}, done{false};
  std::atomic<int> least{thread_count()};
  std::thread watcher([&] {
    watching = true;
    while (!done) least = std::min<int>(least, thread_count());
  });
  while (!watching) std::this_thread::yield();
  run_command(arguments);
  done = true;
  watcher.join();
  return least;
}

TEST(Threads, TheLimitHoldsDuringACommandAndEndsWithIt) {
  const TemporaryFolder folder;
  const std::string bench = places::source() + "/samples/small-bench";
  folder.write("one.csv", "x0_mm,y0_mm,x1_mm,y1_mm\n50,50,54,51\n");
  const std::vector<std::string> render{
      "render", bench + "/board.json",       "--bench",     bench + "/bench.json",        "--view", "d0",
      "--out",  (folder / "a.exr").string(), "--scratches", (folder / "one.csv").string()};
  const int all = thread_count();
  std::vector<std::string> limited{"--threads", "1"};
  limited.insert(limited.end(), render.begin(), render.end());
  EXPECT_EQ(least_threads_during(limited), 1);
  EXPECT_EQ(thread_count(), all);
  limited[1] = "3";
  limited.back() = "missing.csv";
  EXPECT_ANY_THROW(run_command(limited));
  EXPECT_EQ(thread_count(), all);
}

TEST(Threads, AnyNumberMakesTheSameFile) {
  const TemporaryFolder folder;
  const std::string bench = places::source() + "/samples/small-bench";
  std::string rows = "x0_mm,y0_mm,x1_mm,y1_mm\n";
  for (int i = 0; i < 300; ++i)
    rows += std::to_string(20 + i % 20 * 4) + "," + std::to_string(20 + i / 20 * 5) + "," +
            std::to_string(20 + i % 20 * 4 + 3) + "," + std::to_string(20 + i / 20 * 5 + i % 7) + "\n";
  folder.write("some.csv", rows);
  for (const std::string threads : {"1", "4"}) {
    const Outcome run =
        run_burin(folder, {"--threads", threads, "render", bench + "/board.json", "--bench", bench + "/bench.json",
                           "--view", "d0", "--scratches", "some.csv", "--out", threads + ".exr"});
    ASSERT_EQ(run.exit_code, 0) << run.err;
  }
  EXPECT_EQ(read_picture(folder / "1.exr").data, read_picture(folder / "4.exr").data);
}

TEST(Threads, LessThanOneIsAWrongCommandLine) {
  const TemporaryFolder folder;
  for (const char* threads : {"0", "-3", "two"}) {
    const Outcome run = run_burin(folder, {"--threads", threads, "check", "ndf", "cases.csv"});
    EXPECT_EQ(run.exit_code, 2) << threads;
    EXPECT_THAT(run.err, HasSubstr("--threads"));
  }
}

TEST(Threads, AnUnknownCommandBehindIsNamed) {
  const TemporaryFolder folder;
  const Outcome run = run_burin(folder, {"--threads", "2", "etch"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, HasSubstr("no command 'etch'"));
}

}  // namespace
}  // namespace burin
