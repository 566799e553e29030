// A process that is told to stop leaves nothing unfinished behind, whatever its threads are doing just then.
#include "burin/base/files/unfinished.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include "burin/base/files/part_file.h"
#include "burin/base/files/write_file.h"
#include "tests/temporary_folder.h"

namespace burin {
namespace {

// Writes files by several threads until it is told to stop, as a command is told by a signal.
[[noreturn]] void write_and_stop(const std::filesystem::path& folder, std::chrono::microseconds after) {
  std::vector<std::thread> writers;
  for (int i = 0; i < 6; ++i)
    writers.emplace_back([&folder, i] {
      for (int k = 0;; ++k)
        write_file("text", folder / (std::to_string(i) + "-" + std::to_string(k) + ".txt"), Durability::by_the_system);
    });
  std::this_thread::sleep_for(after);
  abandon_unfinished();
  std::this_thread::sleep_for(std::chrono::milliseconds(5));  // whoever was about to write would have
  ::_exit(0);
}

TEST(Unfinished, NothingIsLeftByThreadsThatWereAboutToWrite) {
  int whole = 0;
  for (int run = 0; run < 60; ++run) {
    const TemporaryFolder folder;
    const pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0) write_and_stop(folder.path(), std::chrono::microseconds(1000 + 137 * run));
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    ASSERT_EQ(status, 0);
    for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
      ASSERT_FALSE(is_part_name(entry.path().filename().native())) << entry.path() << " was left, run " << run;
      ++whole;
    }
  }
  EXPECT_GT(whole, 100);  // they were in the midst of it
}

}  // namespace
}  // namespace burin
