// Proves: a plan with very many tags is made with some that are spread over the whole board, and with all of few.
#include "burin/calib/verdict/planned_tags.h"

#include <gtest/gtest.h>

namespace burin {
namespace {

TEST(PlannedTags, AreSpreadOverTheBoard) {
  Board board;
  board.size_mm = {1000, 800};
  for (int i = 0; i < 40; ++i)
    for (int j = 0; j < 25; ++j) {
      Tag tag;
      tag.id = 25 * i + j;
      tag.center_mm = {12.5 + 25.0 * i, 16 + 32.0 * j};
      board.tags.list.push_back(tag);
    }
  const Board some = with_planned_tags(board);
  ASSERT_EQ(some.tags.list.size(), kMostPlannedTags);
  for (std::size_t i = 1; i < some.tags.list.size(); ++i)
    EXPECT_LT(some.tags.list[i - 1].id, some.tags.list[i].id) << "in the board's order, each once";
  // No tag is further from a chosen one than the spacing of 60 places on this board: sqrt(1000 * 800 / 60) = 115 mm.
  for (const Tag& tag : board.tags.list) {
    double nearest = 1e9;
    for (const Tag& chosen : some.tags.list) nearest = std::min(nearest, (chosen.center_mm - tag.center_mm).norm());
    EXPECT_LT(nearest, 115) << tag.id;
  }
  board.tags.list.resize(kMostPlannedTags);
  EXPECT_EQ(with_planned_tags(board).tags.list.size(), kMostPlannedTags);
}

}  // namespace
}  // namespace burin
