#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "burin/base/error.h"
#include "burin/capture/tags/tag_family.h"
#include "tools/print/print_pages.h"

namespace burin {
namespace {

// Space around a tag's paper: for the crop marks, the arrow above, the words below.
constexpr double kCrop_mm = 3.5, kAbove_mm = 5, kBelow_mm = 10, kGap_mm = 3;

Eigen::Vector2d cell_size(double paper_mm) {
  constexpr double kWords_mm = 22;
  return {std::max(paper_mm + 2 * kCrop_mm, kWords_mm), paper_mm + kAbove_mm + kBelow_mm};
}

void require_fits(const Tag& tag, double paper_mm, const PrintSetup& setup) {
  const auto fits = [&](const PrintSetup& on) {
    const Eigen::Vector2d room = free_area(on, kUsualHead_mm).size(), needed = cell_size(paper_mm);
    return needed.x() <= room.x() && needed.y() <= room.y();
  };
  if (fits(setup)) return;
  std::string remedy;
  for (const Paper& paper : papers()) {
    PrintSetup on = setup;
    on.paper = paper;
    if (remedy.empty() && fits(on)) remedy = "print on --paper " + paper.name + ", or make the tag smaller";
  }
  const Eigen::Vector2d room =
      free_area(setup, kUsualHead_mm).size() - Eigen::Vector2d(2 * kCrop_mm, kAbove_mm + kBelow_mm);
  if (remedy.empty()) remedy = "no paper that Burin knows is large enough: make the tag smaller";
  fail(fmt::format("tag {}", tag.id),
       fmt::format(
           "is {:g} mm large, and its paper with the border that it needs {:.1f} mm, while {} has room for {:.0f} mm",
           tag.size_mm, paper_mm, setup.paper.name, room.minCoeff()),
       remedy);
}

// Draws short lines outside of the corners, and a fine gray line along the edge.
void add_cut_lines(Drawing& drawing, const Eigen::Vector2d& low, const Eigen::Vector2d& high) {
  constexpr double kFrom = 0.8;
  add_rectangle(drawing, low, high, Tint::none, {Tint::faint, 0.08, 0});
  for (const double x : {low.x(), high.x()})
    for (const double y : {low.y(), high.y()}) {
      const double out_x = x == low.x() ? -1 : 1, out_y = y == low.y() ? -1 : 1;
      const Pen pen{Tint::ink, 0.1, 0};
      add_line(drawing, {x + out_x * kFrom, y}, {x + out_x * kCrop_mm, y}, pen);
      add_line(drawing, {x, y + out_y * kFrom}, {x, y + out_y * kCrop_mm}, pen);
    }
}

void add_tag(Drawing& drawing, const Tag& tag, const std::string& family, const Eigen::Vector2d& center) {
  const double half = paper_side_mm(tag, family) / 2;
  Shape cells{black_cells(family, tag.id, tag.size_mm), true, Tint::black, {}};
  for (auto& outline : cells.outlines)
    for (Eigen::Vector2d& p : outline) p = center + Eigen::Vector2d(p.x(), -p.y());
  add_cut_lines(drawing, center - Eigen::Vector2d(half, half), center + Eigen::Vector2d(half, half));
  drawing.elements.emplace_back(std::move(cells));
  const double top = center.y() - half, bottom = center.y() + half;
  add_polygon(drawing, {{center.x(), top - 4}, {center.x() + 1.5, top - 1.2}, {center.x() - 1.5, top - 1.2}},
              Tint::ink);
  add_words(drawing, {.at_mm = {center.x() + 2.2, top - 1.6}, .text = "up", .size_mm = 2.2, .tint = Tint::soft});
  add_words(drawing, {.at_mm = {center.x(), bottom + 4.6},
                      .text = fmt::format("id {}", tag.id),
                      .size_mm = 3.4,
                      .anchor = Anchor::middle,
                      .bold = true});
  add_words(drawing, {.at_mm = {center.x(), bottom + 7.6},
                      .text = fmt::format("{:g} mm tag", tag.size_mm),
                      .size_mm = 2.1,
                      .tint = Tint::soft,
                      .anchor = Anchor::middle});
}

}  // namespace

double paper_side_mm(const Tag& tag, const std::string& family) {
  const std::vector<Eigen::Vector2d> corners = tag_paper(tag, family).polygon_mm;
  return (corners[1] - corners[0]).norm();
}

std::vector<std::vector<Eigen::Vector2d>> black_cells(const std::string& family, int id, double size_mm) {
  const TagPattern pattern = tag_pattern(family, id);
  const double cell = size_mm / pattern.border_cells, half = 0.5 * cell * pattern.total_cells;
  std::vector<std::vector<Eigen::Vector2d>> out;
  for (int row = 0; row < pattern.total_cells; ++row)
    for (int column = 0; column < pattern.total_cells;) {
      const auto white = [&](int c) {
        return pattern.white[static_cast<std::size_t>(row) * pattern.total_cells + c] != 0;
      };
      int end = column;
      while (end < pattern.total_cells && !white(end)) ++end;
      if (end > column) {  // a run of black
        const double left = column * cell - half, right = end * cell - half, top = half - row * cell;
        out.push_back({{left, top}, {right, top}, {right, top - cell}, {left, top - cell}});
      }
      column = std::max(end, column + 1);
    }
  return out;
}

TagPages tag_pages(const Board& board, const PrintSetup& setup) {
  if (board.tags.list.empty())
    fail("board.json: tags.list", "names no tag", "list the tags that are to lie on the board");
  TagPages out;
  for (const Tag& tag : board.tags.list) require_fits(tag, paper_side_mm(tag, board.tags.family), setup);
  const FreeArea free = free_area(setup, kUsualHead_mm);
  Eigen::Vector2d at = free.low;
  double row_height = 0;
  std::size_t page = 0;
  for (const Tag& tag : board.tags.list) {
    const double paper = paper_side_mm(tag, board.tags.family);
    const Eigen::Vector2d cell = cell_size(paper);
    if (at.x() + cell.x() > free.high.x() + 1e-9) {
      at = {free.low.x(), at.y() + row_height + kGap_mm};
      row_height = 0;
    }
    if (at.y() + cell.y() > free.high.y() + 1e-9) {
      ++page;
      at = free.low;
      row_height = 0;
    }
    row_height = std::max(row_height, cell.y());
    out.tags.push_back({page, tag.id, at + Eigen::Vector2d(cell.x() / 2, kAbove_mm + paper / 2), tag.size_mm});
    at.x() += cell.x() + kGap_mm;
  }
  for (std::size_t k = 0; k <= page; ++k)
    out.pages.push_back(new_page(
        setup, fmt::format("{}: tags to cut out, page {} of {}", setup.name, k + 1, page + 1),
        {fmt::format("{}: cut along the fine lines, border included. Id and arrow are cut off: cut and stick one tag "
                     "after the other; the template shows each in its place, the same way round.",
                     board.tags.family)}));
  for (std::size_t k = 0; k < out.tags.size(); ++k)
    add_tag(out.pages[out.tags[k].page].drawing, board.tags.list[k], board.tags.family, out.tags[k].center_mm);
  return out;
}

}  // namespace burin
