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
  EXPECT_EQ(consumer.out, "tags=16 half_width_um=50.173 factor=0.000100 adam=3 threads=2\n");
  // What is the house's own business stays there.
  for (const char* folder_within : {"render/fast", "render/exact", "base/files"})
    EXPECT_FALSE(std::filesystem::exists(prefix + "/include/burin/" + folder_within)) << folder_within;
  EXPECT_TRUE(std::filesystem::exists(prefix + "/share/burin/samples/small-bench/board.json"));
  EXPECT_TRUE(std::filesystem::exists(prefix + "/share/doc/burin/LICENSE"));
  EXPECT_TRUE(std::filesystem::exists(prefix + "/share/doc/burin/design.md"));
  EXPECT_TRUE(std::filesystem::exists(prefix + "/share/applications/burin-studio.desktop"));
  EXPECT_TRUE(std::filesystem::exists(prefix + "/share/icons/hicolor/scalable/apps/burin.svg"));
  // Manual pages that man can read, and a completion that bash can run.
  const std::string pages = prefix + "/share/man/man1/";
  EXPECT_THAT(file_text(pages + "burin.1"), ::testing::HasSubstr("burin\\-toolpath (1)"));
  EXPECT_THAT(file_text(pages + "burin-capture.1"), ::testing::HasSubstr("\\-\\-bench"));
  const Outcome completed =
      run_shell(folder, "bash -c '. " + prefix + "/share/bash-completion/completions/burin; COMP_WORDS=(burin cap); " +
                            "COMP_CWORD=1; _burin; echo \"${COMPREPLY[*]}\"; COMP_WORDS=(burin capture --la); " +
                            "COMP_CWORD=2; _burin; echo \"${COMPREPLY[*]}\"'");
  EXPECT_EQ(completed.out, "capture\n--lamp\n") << completed.err;
  const Outcome program = run_shell(folder, quoted(prefix + "/bin/burin") + " --version");
  EXPECT_EQ(program.exit_code, 0) << program.err;
}

// What is missing is said at once, each with its package, and so are targets that a library links and nobody has.
TEST(Needs, AreNamedTogetherWithTheirPackages) {
  const TemporaryFolder folder;
  folder.write("old/OldConfig.cmake", "");
  folder.write("old/OldConfigVersion.cmake", "set(PACKAGE_VERSION 1.5)\n");
  folder.write("old/CudaConfig.cmake", "include(CMakeFindDependencyMacro)\nfind_dependency(CUDAToolkit)\n");
  folder.write("CMakeLists.txt",
               "cmake_minimum_required(VERSION 3.25)\nproject(needs NONE)\ninclude(" + places::source() +
                   "/cmake/burin_needs.cmake)\n"
                   "burin_needs(Missing \"A missing one\" libmissing-dev https://missing.example)\n"
                   "burin_needs(Old \"Old 2 or newer\" libold-dev https://old.example 2)\n"
                   "add_library(Solver::solver INTERFACE IMPORTED)\n"
                   "set_target_properties(Solver::solver PROPERTIES INTERFACE_LINK_LIBRARIES "
                   "\"$<LINK_ONLY:CUDA::cublas>;CUDA::cusolver;m\")\n"
                   "burin_needs_what_links(Solver::solver \"Solver\" libsolver-dev https://solver.example)\n"
                   "burin_needs(Cuda \"A solver\" libcuda-dev https://cuda.example)\n"
                   "burin_settle_needs()\n");
  const std::string at = folder.path().string();
  const Outcome run = run_shell(folder, "cmake -S " + quoted(at) + " -B " + quoted(at + "/build") +
                                            " -DCMAKE_PREFIX_PATH=" + quoted(at + "/old") +
                                            " -DCMAKE_DISABLE_FIND_PACKAGE_CUDAToolkit=ON");
  EXPECT_NE(run.exit_code, 0);
  using ::testing::HasSubstr;
  EXPECT_THAT(run.err, HasSubstr("  A missing one: Debian's libmissing-dev, or https://missing.example\n"));
  EXPECT_THAT(run.err, HasSubstr("  Old 2 or newer, and not 1.5: Debian's libold-dev, or https://old.example\n"));
  EXPECT_THAT(run.err,
              HasSubstr("this Solver was built with CUDA and links CUDA::cublas, CUDA::cusolver (without CUDA: "
                        "libsolver-dev): Debian's nvidia-cuda-toolkit"));
  EXPECT_THAT(run.err, HasSubstr("CUDA's toolkit, since this Cuda was built with CUDA (it is there, but: "));
  EXPECT_THAT(run.err, HasSubstr("  apt-get install libmissing-dev libold-dev nvidia-cuda-toolkit\n"));
}

TEST(Needs, OfBurinAreNamedWhereTheyAreMissing) {
  const TemporaryFolder folder;
  // mrcal has no CMake package to be disabled: its header is hidden, and all others of that folder with it.
  const Outcome run = run_shell(
      folder, "cmake -S " + quoted(places::source()) + " -B " + quoted((folder / "build").string()) +
                  " -DBURIN_BUILD_TESTS=OFF -DCMAKE_DISABLE_FIND_PACKAGE_Ceres=ON -DCMAKE_IGNORE_PATH=/usr/include");
  EXPECT_NE(run.exit_code, 0);
  EXPECT_THAT(run.err, ::testing::AllOf(::testing::HasSubstr("Ceres Solver 2.1 or newer: Debian's libceres-dev"),
                                        ::testing::HasSubstr("mrcal 2.2 or newer: Debian's libmrcal-dev, or "
                                                             "https://mrcal.secretsauce.net/install.html")));
}

}  // namespace
}  // namespace burin
