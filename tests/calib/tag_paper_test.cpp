// Proves: the paper that tool paths keep free of a tag is as wide as AprilTag draws the tag.
#include <gtest/gtest.h>

#include "capture/tag_family.h"
#include "render/board.h"
#include "render/error.h"

namespace burin {
namespace {

TEST(TagPaper, IsAsWideAsAprilTagDrawsIt) {
  for (const char* family : {"tag16h5", "tag25h9", "tag36h10", "tag36h11", "tagCircle21h7", "tagCircle49h12",
                             "tagCustom48h12", "tagStandard41h12", "tagStandard52h13"}) {
    const TagPattern pattern = tag_pattern(family, 0);
    const KeepOut paper = tag_paper({0, {50, 40}, 10, 0}, family);
    ASSERT_EQ(paper.polygon_mm.size(), 4U);
    const double side = 10.0 * pattern.total_cells / pattern.border_cells;
    EXPECT_NEAR((paper.polygon_mm[1] - paper.polygon_mm[0]).norm(), side, 1e-12) << family;
    EXPECT_NEAR(paper.polygon_mm[0].x(), 50 - side / 2, 1e-12) << family;
  }
  EXPECT_THROW(tag_paper({}, "tag99"), Error);
}

}  // namespace
}  // namespace burin
