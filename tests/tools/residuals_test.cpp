// residuals.vnl as burin calibrate writes it is read back; what is broken is named with its line.
#include "tools/report/residuals.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "burin/base/error.h"
#include "tests/temporary_folder.h"

namespace burin {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

TEST(Residuals, AreReadByTheNamesOfTheirColumns) {
  const TemporaryFolder folder;
  const auto file = folder.write("residuals.vnl",
                                 "# view tag corner x_px y_px dx_px dy_px sigma_px used photo\n"
                                 "## a comment\n"
                                 "v00 7 0 12.5 -3.25 0.3 -0.4 0.1 1 a.png\n"
                                 "v01 8 1 1e2 5 3 4 0.1 0 b.png\n");
  const ResidualTable table = read_residuals(file);
  ASSERT_EQ(table.corners.size(), 2U);
  EXPECT_EQ(table.corners[0].view, "v00");
  EXPECT_EQ(table.corners[0].tag, 7);
  EXPECT_EQ(table.corners[0].q_px, Eigen::Vector2d(12.5, -3.25));
  EXPECT_FALSE(table.corners[0].left_out);
  EXPECT_EQ(table.corners[1].q_px.x(), 100);
  EXPECT_TRUE(table.corners[1].left_out);
  EXPECT_DOUBLE_EQ(table.rms_px(), std::sqrt(0.25 / 2));  // the one that was used: 0.3, -0.4
}

TEST(Residuals, BrokenOnesAreNamedAndMissingOnesAreNone) {
  const TemporaryFolder folder;
  EXPECT_TRUE(read_residuals(folder / "none.vnl").corners.empty());
  const std::string legend = "# view tag corner x_px y_px dx_px dy_px used\n";
  const auto comma = folder.write("comma.vnl", legend + "v00 7 0 12,5 3 0 0 1\n");
  EXPECT_THAT([&] { read_residuals(comma); }, ThrowsMessage<Error>(AllOf(HasSubstr(":2"), HasSubstr("\"12,5\""))));
  const auto cut = folder.write("cut.vnl", legend + "v00 7 0 12.5\n");
  EXPECT_THAT([&] { read_residuals(cut); }, ThrowsMessage<Error>(HasSubstr("y_px")));
  for (const char* tag : {"1e300", "3000000000", "7.5"}) {  // what no int holds
    const auto odd = folder.write("odd.vnl", legend + "v00 " + tag + " 0 12.5 3 0 0 1\n");
    EXPECT_THAT([&] { read_residuals(odd); }, ThrowsMessage<Error>(HasSubstr("whole number"))) << tag;
  }
}

}  // namespace
}  // namespace burin
