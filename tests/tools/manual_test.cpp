// Proves: docs/commands.md is the program's own page of its commands.
#include "tools/manual.h"

#include <gtest/gtest.h>

#include "tests/places.h"
#include "tests/temporary_folder.h"
#include "tools/command_line.h"

namespace burin {
namespace {

TEST(Manual, TheReferenceInTheDocumentsIsTheProgramsOwn) {
  EXPECT_EQ(file_text(places::source() + "/docs/commands.md"), commands_page(*make_app()))
      << "copy build/release/manual/commands.md to docs/commands.md";
}

}  // namespace
}  // namespace burin
