// Proves: who begins in the moment in which another has locked a project but not yet said who it is waits for its
// words, and works if it was only asked who works there; a folder that is held is refused with the holder's words, and
// one process may hold it twice.
#include "tools/work_lock.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <unistd.h>

#include <chrono>
#include <string>
#include <thread>

#include "burin/base/error.h"
#include "burin/base/files/descriptor.h"
#include "tests/temporary_folder.h"

namespace burin {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr std::chrono::milliseconds kMoment(30);  // well below what is waited for words

// Another process' lock, as the kernel sees it: of a file that was opened by itself.
Descriptor locked_by_another(const TemporaryFolder& folder) {
  Descriptor file(::open((folder / ".burin-lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666));
  EXPECT_EQ(::flock(file.number(), LOCK_EX | LOCK_NB), 0);
  return file;
}

void say(const Descriptor& file, const std::string& words) {
  EXPECT_EQ(::pwrite(file.number(), words.data(), words.size(), 0), static_cast<ssize_t>(words.size()));
}

TEST(WorkLock, WhoHasOnlyBegunIsWaitedForUntilItSaysWhoItIs) {
  const TemporaryFolder folder;
  const Descriptor other = locked_by_another(folder);
  std::thread soon([&] {
    std::this_thread::sleep_for(kMoment);
    say(other, "burin loop, process 4711 since 2025-06-01 10:30:00\n");
  });
  EXPECT_THAT([&] { const WorkLock lock(folder.path(), "burin design"); },
              ThrowsMessage<Error>(HasSubstr("is being worked on by burin loop, process 4711 since 2025")));
  soon.join();
}

TEST(WorkLock, WhoOnlyAsksWhoWorksThereKeepsNobodyFromIt) {
  const TemporaryFolder folder;
  Descriptor other = locked_by_another(folder);
  std::thread soon([&] {
    std::this_thread::sleep_for(kMoment);
    other = Descriptor();
  });
  EXPECT_NO_THROW(const WorkLock lock(folder.path(), "burin design"));
  soon.join();
  EXPECT_EQ(who_works_in(folder.path()), "");
}

TEST(WorkLock, ASilentHolderIsNamedAsAnotherProcess) {
  const TemporaryFolder folder;
  const Descriptor other = locked_by_another(folder);
  const auto began = std::chrono::steady_clock::now();
  EXPECT_THAT([&] { const WorkLock lock(folder.path(), "burin design"); },
              ThrowsMessage<Error>(HasSubstr("is being worked on by another process")));
  EXPECT_GT(std::chrono::steady_clock::now() - began, 4 * kMoment);
}

TEST(WorkLock, TheSameProcessMayHoldItTwice) {
  const TemporaryFolder folder;
  const WorkLock outer(folder.path(), "burin loop");
  { const WorkLock inner(folder.path(), "burin design"); }
  EXPECT_THAT(who_works_in(folder.path()), HasSubstr("burin loop, process " + std::to_string(::getpid()) + " since"));
}

}  // namespace
}  // namespace burin
