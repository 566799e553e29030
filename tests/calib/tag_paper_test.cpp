// Proves: the paper that tool paths keep free of a tag is as wide as AprilTag draws the tag; photos are not compared on
// the paper, on keep-outs (a clamp, a hole) and beyond the board.
#include <gtest/gtest.h>

#include "burin/base/error.h"
#include "burin/calib/light/light_samples.h"
#include "burin/capture/tags/tag_family.h"
#include "burin/scene/board.h"

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

TEST(MetalMask, LeavesOutPaperKeepOutsAndTheEdge) {
  Board board;
  board.size_mm = {100, 80};
  board.tags.family = "tagStandard41h12";
  board.tags.list = {{0, {20, 20}, 10, 0}};
  board.keep_out = {{"hole", {}, {70, 40}, 6}};
  Bench bench;
  bench.tags = board.tags.list;
  const BoardMask metal = metal_mask(board, bench, 1);
  EXPECT_TRUE(metal.is_free(50, 60));
  EXPECT_FALSE(metal.is_free(20, 20));    // the tag
  EXPECT_FALSE(metal.is_free(70, 40));    // the hole
  EXPECT_FALSE(metal.is_free(76.5, 40));  // its margin
  EXPECT_TRUE(metal.is_free(77.5, 40));
  EXPECT_FALSE(metal.is_free(99.5, 60));  // the edge
}

}  // namespace
}  // namespace burin
