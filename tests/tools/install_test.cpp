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
  // With the same sanitizers, if any: what they instrumented links with nothing else.
  const Outcome configure =
      run_shell(folder, "cmake -G Ninja -S " + quoted(places::source() + "/tests/tools/consumer") + " -B " +
                            quoted(build) + " -DCMAKE_PREFIX_PATH=" + quoted(prefix) + " " + places::compiler());
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
  // Manual pages that man can read, and a completion that bash can run.
  const std::string pages = prefix + "/share/man/man1/";
  EXPECT_THAT(file_text(pages + "burin.1"), ::testing::HasSubstr("burin\\-toolpath (1)"));
  EXPECT_THAT(file_text(pages + "burin-capture.1"), ::testing::HasSubstr("\\-\\-bench"));
  const Outcome completed =
      run_shell(folder, "bash -c '. " + prefix + "/share/bash-completion/completions/burin; COMP_WORDS=(burin cap); " +
                            "COMP_CWORD=1; _burin; echo \"${COMPREPLY[*]}\"; COMP_WORDS=(burin capture --li); " +
                            "COMP_CWORD=2; _burin; echo \"${COMPREPLY[*]}\"'");
  EXPECT_EQ(completed.out, "capture\n--light\n") << completed.err;
  const Outcome program = run_shell(folder, quoted(prefix + "/bin/burin") + " --version");
  EXPECT_EQ(program.exit_code, 0) << program.err;
}

}  // namespace
}  // namespace burin
