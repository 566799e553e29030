// The progress line says how far the work is and guesses the time left from the time so far. That nothing is drawn
// without a terminal is proved by every program test, whose stderr is a file.
#include "tools/progress_bar.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <string>

namespace burin {
namespace {

TEST(ProgressLine, GuessesTheTimeLeftFromTheTimeSoFar) {
  EXPECT_EQ(progress_line("finding tags", 0.25, 30), "[#####---------------]  25 %  finding tags, 1:30 left");
  EXPECT_EQ(progress_line("finding tags", 1, 30), "[####################] 100 %  finding tags, 0:00 left");
}

TEST(ProgressLine, DoesNotGuessFromTooLittle) {
  EXPECT_EQ(progress_line("solving", 0.01, 3), "[--------------------]   1 %  solving");
}

TEST(ProgressLine, SurvivesFractionsThatAreNone) {
  EXPECT_EQ(progress_line("solving", std::nan(""), 3), "[--------------------]   0 %  solving");
  EXPECT_EQ(progress_line("solving", 7, 3), "[####################] 100 %  solving, 0:00 left");
  EXPECT_EQ(progress_line("solving", -1, 3), "[--------------------]   0 %  solving");
}

// Standard error on a terminal of its own while one lives.
class OwnTerminal {
 public:
  OwnTerminal() : terminal_(::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC)), before_(::dup(STDERR_FILENO)) {
    if (terminal_ < 0 || ::grantpt(terminal_) != 0 || ::unlockpt(terminal_) != 0) return;
    const int line = ::open(::ptsname(terminal_), O_RDWR | O_NOCTTY | O_CLOEXEC);
    usable_ = line >= 0 && ::dup2(line, STDERR_FILENO) >= 0;
    ::close(line);
  }
  ~OwnTerminal() {
    ::dup2(before_, STDERR_FILENO);
    ::close(before_);
    ::close(terminal_);
  }
  OwnTerminal(const OwnTerminal&) = delete;
  OwnTerminal& operator=(const OwnTerminal&) = delete;

  bool usable() const { return usable_; }

  // What comes until it holds `text`, or for so long.
  std::string read_until(const std::string& text, std::chrono::milliseconds longest) const {
    const auto end = std::chrono::steady_clock::now() + longest;
    std::string out;
    while (out.find(text) == std::string::npos && std::chrono::steady_clock::now() < end) {
      pollfd waiting{terminal_, POLLIN, 0};
      char part[512];
      if (::poll(&waiting, 1, 50) > 0)
        if (const ssize_t got = ::read(terminal_, part, sizeof part); got > 0)
          out.append(part, static_cast<std::size_t>(got));
    }
    return out;
  }

 private:
  int terminal_, before_;
  bool usable_ = false;
};

TEST(ProgressBar, ShowsWorkThatIsSilentForLong) {
  const OwnTerminal terminal;
  if (!terminal.usable()) GTEST_SKIP() << "no terminal can be had";
  constexpr auto kLong = std::chrono::seconds(60), kShort = std::chrono::seconds(1);
  using ::testing::HasSubstr;
  {
    ProgressBar bar;
    bar.progress()("reading scratches", 0);
    EXPECT_EQ(terminal.read_until("scratches", kShort), "") << "the first two seconds are quiet";
    EXPECT_THAT(terminal.read_until("scratches", kLong), HasSubstr("[--------------------]   0 %  reading scratches"));
    // At once after another one: later than a tenth of a second nobody would draw it.
    bar.progress()("carving", 0.25);
    bar.progress()("writing", 0.5);
    EXPECT_THAT(terminal.read_until("writing", kLong), HasSubstr("50 %  writing"));
    bar.clear();
    EXPECT_THAT(terminal.read_until("\x1b[K", kLong), HasSubstr("\r\x1b[K"));
    EXPECT_EQ(terminal.read_until("writing", kShort), "") << "what was cleared stays away";
    bar.progress()("ending", 1);
    EXPECT_THAT(terminal.read_until("ending", kLong), HasSubstr("ending"));
  }
  terminal.read_until("\r\x1b[K", kLong);
  {
    ProgressBar bar;  // short work, ended while its thread waits
    bar.progress()("short", 0);
  }
  EXPECT_EQ(terminal.read_until("short", kShort), "");
}

}  // namespace
}  // namespace burin
