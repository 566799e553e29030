// What `cmake --install` leaves is enough for another project: find_package(burin), our headers and libraries, and
// nothing of this source tree but the sample board that the consumer is asked to read.
#include <gmock/gmock.h>

#include "tests/places.h"
#include "tests/tools/program.h"

namespace burin {
namespace {

TEST(Install, AnotherProjectFindsBurinAndUsesIt) {
  const TemporaryFolder folder;
  const std::string prefix = (folder / "prefix").string(), build = (folder / "build").string();
  const Outcome install =
      run_shell(folder, "cmake --install " + quoted(places::binary()) + " --prefix " + quoted(prefix));
  ASSERT_EQ(install.exit_code, 0) << install.out << install.err;
  const Outcome configure =
      run_shell(folder, "cmake -G Ninja -S " + quoted(places::source() + "/tests/tools/consumer") + " -B " +
                            quoted(build) + " -DCMAKE_PREFIX_PATH=" + quoted(prefix));
  ASSERT_EQ(configure.exit_code, 0) << configure.out << configure.err;
  const Outcome compile = run_shell(folder, "cmake --build " + quoted(build));
  ASSERT_EQ(compile.exit_code, 0) << compile.out << compile.err;
  const Outcome consumer = run_shell(
      folder, quoted(build + "/consumer") + " " + quoted(places::source() + "/samples/small-bench/board.json"));
  EXPECT_EQ(consumer.exit_code, 0) << consumer.err;
  // w of a groove with wt = 400 um, d = 11 um: 200 sqrt(1 - exp(-0.055)).
  EXPECT_EQ(consumer.out, "tags=16 half_width_um=46.267 factor=0.000100 adam=3 threads=2\n");
  // What is the house's own business stays there.
  for (const char* folder_within : {"render/fast", "render/exact", "render/files"})
    EXPECT_FALSE(std::filesystem::exists(prefix + "/include/burin/" + folder_within)) << folder_within;
  EXPECT_TRUE(std::filesystem::exists(prefix + "/share/burin/samples/small-bench/board.json"));
  EXPECT_TRUE(std::filesystem::exists(prefix + "/share/doc/burin/LICENSE"));
  EXPECT_TRUE(std::filesystem::exists(prefix + "/share/doc/burin/design.md"));
  const Outcome program = run_shell(folder, quoted(prefix + "/bin/burin") + " --version");
  EXPECT_EQ(program.exit_code, 0) << program.err;
}

}  // namespace
}  // namespace burin
