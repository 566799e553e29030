// Proves: a misspelled command or option is named with the one that was meant, before any other complaint; help comes
// in every form that people try; the environment stands for the options.
#include <gmock/gmock.h>

#include <cstdlib>

#include "tests/tools/program.h"

namespace burin {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

TEST(CommandNames, AMisspelledOneIsGuessed) {
  const TemporaryFolder folder;
  const auto said = [&](const std::vector<std::string>& words) {
    const Outcome run = run_burin(folder, words);
    EXPECT_EQ(run.exit_code, 2) << run.err;
    return run.err;
  };
  EXPECT_THAT(said({"desing", "x"}), HasSubstr("there is no command 'desing'; did you mean 'design'?"));
  EXPECT_THAT(said({"calib", "x"}), HasSubstr("did you mean 'calibrate'?"));
  EXPECT_THAT(said({"etch"}), AllOf(HasSubstr("there is no command 'etch'; there are: "), HasSubstr("toolpath")));
  EXPECT_THAT(said({"design", "--iteration", "5", "x"}),
              HasSubstr("burin design does not take '--iteration'; did you mean '--iterations'?"));
  EXPECT_THAT(said({"check", "carve", "--machin=grbl"}),
              HasSubstr("burin check carve does not take '--machin'; did you mean '--machine'?"));
  EXPECT_THAT(said({"status", "--thread", "1"}), HasSubstr("did you mean '--threads'?"));
  EXPECT_THAT(said({"status", "a", "b"}), HasSubstr("burin status does not take 'b'"));
}

TEST(CommandNames, HelpComesInEveryForm) {
  const TemporaryFolder folder;
  const Outcome all = run_burin(folder, {"--help"});
  EXPECT_EQ(all.exit_code, 0);
  EXPECT_THAT(all.out, AllOf(HasSubstr("Photograph:"), HasSubstr("Calibrate:"), HasSubstr("burin help COMMAND")));
  EXPECT_EQ(run_burin(folder, {}).out, all.out);
  EXPECT_EQ(run_burin(folder, {"help"}).out, all.out);
  EXPECT_EQ(run_burin(folder, {"help", "check", "carve"}).out, run_burin(folder, {"check", "carve", "--help"}).out);
}

TEST(CommandNames, TheEnvironmentLimitsThreads) {
  const TemporaryFolder folder;
  setenv("BURIN_THREADS", "none", 1);
  const Outcome wrong = run_burin(folder, {"status"});
  unsetenv("BURIN_THREADS");
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_THAT(wrong.err, HasSubstr("BURIN_THREADS: \"none\" is not a number of threads; give 1 or more"));
}

}  // namespace
}  // namespace burin
