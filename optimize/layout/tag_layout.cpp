#include "burin/optimize/layout/tag_layout.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "burin/base/error.h"
#include "burin/base/files/decimals.h"

namespace burin {
namespace {

constexpr double kPaper = 9.0 / 5;  // of a 41h12: modules across its paper, and across the measured square
constexpr double kGap_mm = 1;       // to the edge, and to the carve area: tags are cut out and glued by hand
constexpr double kGlued_mm = 0.5;   // standard deviation of the position of tags glued by hand with a template
constexpr double kSmallest_mm = 4;  // a module of 0.8 mm, within the reach of any printer

double center_mm(double tag_mm) { return std::ceil(kGap_mm + kPaper * tag_mm / 2); }
double border_mm(double tag_mm) { return std::ceil(center_mm(tag_mm) + kPaper * tag_mm / 2 + kGap_mm); }

std::string size_text(const Eigen::Vector2d& mm) {
  return significant(mm.x(), 4) + " x " + significant(mm.y(), 4) + " mm";
}

// Whole mm from `low` to `high`, both included, with room for scissors between papers.
std::vector<double> places(double low, double high, double pitch_mm, double paper_mm) {
  constexpr double kApart = 1.3;
  const double length = high - low;
  int steps = static_cast<int>(std::lround(length / pitch_mm));
  steps = std::clamp(steps, 1, std::max(1, static_cast<int>(length / (kApart * paper_mm))));
  std::vector<double> out;
  for (int i = 0; i <= steps; ++i) out.push_back(i == steps ? high : std::round(low + length * i / steps));
  return out;
}

}  // namespace

TagSizes tag_sizes(const Eigen::Vector2d& board_mm) {
  const double shorter = board_mm.minCoeff();
  constexpr double kLargestBoard_mm = 5000;
  if (!board_mm.allFinite() || shorter <= 0 || board_mm.maxCoeff() > kLargestBoard_mm)
    fail("a board of " + size_text(board_mm), "cannot be made", "give width and height, each up to 5000 mm");
  TagSizes sizes;
  while (border_mm(sizes.largest_mm + 1) <= shorter / 4) ++sizes.largest_mm;
  if (sizes.largest_mm < kSmallest_mm)
    fail("a board of " + size_text(board_mm), "is too small for tags around a picture",
         "take one whose sides are at least " + significant(4 * border_mm(kSmallest_mm), 4) + " mm");
  constexpr double kUsualBorder = 0.15, kUsualLargest_mm = 25;  // of the shorter side; larger tags add no information
  sizes.usual_mm = std::floor((kUsualBorder * shorter - 2 * kGap_mm) / kPaper);
  sizes.usual_mm = std::clamp(sizes.usual_mm, kSmallest_mm + 1, kUsualLargest_mm);
  sizes.usual_mm = std::min(sizes.usual_mm, sizes.largest_mm);
  return sizes;
}

Board board_with_tags(const Eigen::Vector2d& board_mm, double tag_mm) {
  const double paper = kPaper * tag_mm, low = center_mm(tag_mm), border = border_mm(tag_mm);
  if (tag_mm < kSmallest_mm || tag_mm > tag_sizes(board_mm).largest_mm)
    fail("tags of " + significant(tag_mm, 4) + " mm", "do not fit a board of " + size_text(board_mm),
         "take 4 to " + significant(tag_sizes(board_mm).largest_mm, 4) + " mm");
  Board board;
  board.size_mm = board_mm;
  board.tags.sigma_mm = kGlued_mm;
  board.carve_min_mm = {border, border};
  board.carve_max_mm = {std::floor(board_mm.x() - border), std::floor(board_mm.y() - border)};
  const Eigen::Vector2d high(std::floor(board_mm.x() - low), std::floor(board_mm.y() - low));
  constexpr int kTags = 16;
  const double pitch = 2 * (high.x() + high.y() - 2 * low) / kTags;
  std::vector<double> xs = places(low, high.x(), pitch, paper), ys = places(low, high.y(), pitch, paper);
  // Two tags in a row would leave the warp of a side undetermined.
  const auto with_middle = [&](std::vector<double>& list) {
    if (list.size() == 2 && list[1] - list[0] >= 2 * paper + 2)
      list.insert(list.begin() + 1, std::round((list[0] + list[1]) / 2));
  };
  with_middle(xs);
  with_middle(ys);
  const auto add = [&](double x, double y) {
    board.tags.list.push_back({static_cast<int>(board.tags.list.size()), {x, y}, tag_mm, 0});
  };
  for (const double x : xs) add(x, low);
  for (std::size_t i = 1; i < ys.size(); ++i) add(high.x(), ys[i]);
  for (std::size_t i = xs.size() - 1; i-- > 0;) add(xs[i], high.y());
  for (std::size_t i = ys.size() - 1; i-- > 1;) add(low, ys[i]);
  return board;
}

}  // namespace burin
