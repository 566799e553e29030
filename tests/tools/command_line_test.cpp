// The program's door: every command is there, helps with an example, and says by its exit code whether it
// was done (0), could not be done (1) or was asked wrongly (2). What the commands do is proved by other tests.
#include <gmock/gmock.h>

#include "tests/tools/program.h"

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

INSTANTIATE_TEST_SUITE_P(Burin, Command, ::testing::Values("capture", "simulate", "report", "check"),
                         [](const auto& info) { return std::string(info.param); });

TEST(CommandLine, VersionAndHelpAreDone) {
  const TemporaryFolder folder;
  EXPECT_THAT(run_burin(folder, {"--version"}).out, HasSubstr("burin "));
  const Outcome help = run_burin(folder, {"--help"});
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_THAT(help.out, HasSubstr("calibrate"));
}

TEST(CommandLine, AnUnknownCommandIsNamed) {
  const TemporaryFolder folder;
  const Outcome run = run_burin(folder, {"etch"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, HasSubstr("etch"));
}

}  // namespace
}  // namespace burin
