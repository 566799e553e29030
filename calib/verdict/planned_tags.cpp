#include "burin/calib/verdict/planned_tags.h"

#include <algorithm>
#include <limits>
#include <vector>

namespace burin {

Board with_planned_tags(const Board& board) {
  const std::vector<Tag>& all = board.tags.list;
  if (all.size() <= kMostPlannedTags) return board;
  std::vector<double> distance_mm(all.size(), std::numeric_limits<double>::infinity());
  std::vector<std::size_t> chosen;
  std::size_t next = 0;
  for (std::size_t i = 1; i < all.size(); ++i)  // from the lower left corner
    if (all[i].center_mm.sum() < all[next].center_mm.sum()) next = i;
  while (chosen.size() < kMostPlannedTags) {
    chosen.push_back(next);
    for (std::size_t i = 0; i < all.size(); ++i)
      distance_mm[i] = std::min(distance_mm[i], (all[i].center_mm - all[chosen.back()].center_mm).norm());
    next = static_cast<std::size_t>(std::max_element(distance_mm.begin(), distance_mm.end()) - distance_mm.begin());
  }
  std::sort(chosen.begin(), chosen.end());
  Board out = board;
  out.tags.list.clear();
  for (const std::size_t i : chosen) out.tags.list.push_back(all[i]);
  return out;
}

}  // namespace burin
