// Proves that a design which has no room is refused with a size that has, and that the system's word is heard.
#include "burin/optimize/design/design_memory.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "burin/base/error.h"

namespace burin {
namespace {

using testing::HasSubstr;

std::string refusal(double pixels, int longer_px, double scratches, double free) {
  try {
    require_memory(pixels, longer_px, scratches, free);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(DesignMemory, IsRefusedWithASizeThatFits) {
  EXPECT_EQ(refusal(3e5, 384, 12000, 1e9), "");
  const std::string pixels = refusal(3e7, 2048, 1e5, 1e9);
  EXPECT_THAT(pixels, HasSubstr("1.0 GB are free"));
  const std::size_t at = pixels.find("--pixels ");
  ASSERT_NE(at, std::string::npos) << pixels;
  const int fits = std::stoi(pixels.substr(at + 9));
  EXPECT_GT(fits, 1000);
  EXPECT_EQ(refusal(3e7 * fits * fits / 2048.0 / 2048, fits, 1e5, 1e9), "");
  const std::string scratches = refusal(3e5, 384, 2e6, 1e9);
  const std::size_t number = scratches.find("--scratches ");
  ASSERT_NE(number, std::string::npos) << scratches;
  EXPECT_EQ(refusal(3e5, 384, std::stod(scratches.substr(number + 12)), 1e9), "");
}

TEST(DesignMemory, TheSystemSaysWhatIsFree) {
  const auto free = free_bytes();
  if (!free) GTEST_SKIP() << "this system does not say";
  EXPECT_GT(*free, 1e6);
  EXPECT_LT(*free, 1e15);
}

}  // namespace
}  // namespace burin
