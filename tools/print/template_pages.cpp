#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "burin/base/error.h"
#include "tools/print/print_pages.h"

namespace burin {
namespace {

constexpr double kBeyond_mm = 8;    // visible strip around the board, with the marks of its edges
constexpr double kOverlap_mm = 12;  // of neighboring tiles
constexpr double kHead_mm = 32;     // with the overview
constexpr double kLabel_mm = 3;     // of a tag's number
constexpr int kMostPages = 400;

struct PaperBox {
  Eigen::Vector2d low, high;
};

bool overlap(const PaperBox& a, const PaperBox& b) {
  return (a.low.array() < b.high.array()).all() && (b.low.array() < a.high.array()).all();
}

PaperBox around(const std::vector<Eigen::Vector2d>& points) {
  PaperBox box{points[0], points[0]};
  for (const Eigen::Vector2d& p : points) box = {box.low.cwiseMin(p), box.high.cwiseMax(p)};
  return box;
}

bool covers(const std::vector<Eigen::Vector2d>& convex, const Eigen::Vector2d& p, double margin) {
  for (std::size_t i = 0; i < convex.size(); ++i) {
    const Eigen::Vector2d side = (convex[(i + 1) % convex.size()] - convex[i]).normalized(), to = p - convex[i];
    if (side.x() * to.y() - side.y() * to.x() < -margin) return false;  // corners run counter-clockwise
  }
  return true;
}

// Number of tiles along a side of the board, and length of each.
struct Row {
  int count = 1;
  double length = 0;
  double from(int i) const { return -kBeyond_mm + i * (length - kOverlap_mm); }
};

Row row_of(double board_mm, double room_mm) {
  const double all = board_mm + 2 * kBeyond_mm;
  Row row;
  row.count = std::max(1, static_cast<int>(std::ceil((all - kOverlap_mm) / (room_mm - kOverlap_mm) - 1e-9)));
  row.length = (all + (row.count - 1) * kOverlap_mm) / row.count;
  return row;
}

struct Tiling {
  Row columns, rows;  // along the board's x and y
  bool turned = false;
  int pages() const { return columns.count * rows.count; }
};

// Chooses the rotation with fewer pages.
Tiling tiling_of(const Board& board, const PrintSetup& setup) {
  const Eigen::Vector2d room = free_area(setup, kHead_mm).size();
  const Tiling upright{row_of(board.size_mm.x(), room.x()), row_of(board.size_mm.y(), room.y()), false};
  const Tiling turned{row_of(board.size_mm.x(), room.y()), row_of(board.size_mm.y(), room.x()), true};
  return turned.pages() < upright.pages() ? turned : upright;
}

// Draws board coordinates onto one tile's page, clipped to the tile.
struct TilePen {
  Drawing& drawing;
  const Tile& tile;

  void line(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Pen& pen) const {
    const auto seen = clipped_line(a, b, tile.low_mm, tile.high_mm);
    if (!seen.empty()) add_line(drawing, tile.on_page(seen[0]), tile.on_page(seen[1]), pen);
  }
  void outline(const std::vector<Eigen::Vector2d>& corners, const Pen& pen) const {
    for (std::size_t i = 0; i < corners.size(); ++i) line(corners[i], corners[(i + 1) % corners.size()], pen);
  }
  void fill(const std::vector<std::vector<Eigen::Vector2d>>& polygons, Tint tint) const {
    Shape shape{{}, true, tint, {}};
    for (const auto& polygon : polygons) {
      std::vector<Eigen::Vector2d> seen = clipped(polygon, tile.low_mm, tile.high_mm);
      for (Eigen::Vector2d& p : seen) p = tile.on_page(p);
      if (seen.size() > 2) shape.outlines.push_back(std::move(seen));
    }
    if (!shape.outlines.empty()) drawing.elements.emplace_back(std::move(shape));
  }
  bool shows(const Eigen::Vector2d& p, double margin = 0) const {
    return ((p - tile.low_mm).array() >= margin).all() && ((tile.high_mm - p).array() >= margin).all();
  }
  void words(const Eigen::Vector2d& at, const std::string& text, double size, Tint tint, bool bold = false) const {
    add_words(drawing, {.at_mm = tile.on_page(at),
                        .text = text,
                        .size_mm = size,
                        .tint = tint,
                        .anchor = Anchor::middle,
                        .bold = bold,
                        .centered = true,
                        .turn_deg = tile.turned ? 90.0 : 0.0});
  }
};

std::vector<Eigen::Vector2d> rectangle(const Eigen::Vector2d& low, const Eigen::Vector2d& high) {
  return {low, {high.x(), low.y()}, high, {low.x(), high.y()}};
}

// Marks next to a tag's paper: an arrow at its upper side and its number, clear of other tags if possible.
struct TagMarks {
  std::vector<Eigen::Vector2d> paper, arrow;
  Eigen::Vector2d number_mm;
  std::string number;
};

std::vector<TagMarks> marks_of(const Board& board) {
  std::vector<TagMarks> out;
  std::vector<PaperBox> taken;
  const auto is_free = [&](const PaperBox& box, std::size_t but) {
    for (std::size_t i = 0; i < taken.size(); ++i)
      if (i != but && overlap(taken[i], box)) return false;
    return true;
  };
  for (const Tag& tag : board.tags.list) {
    TagMarks marks;
    marks.paper = tag_paper(tag, board.tags.family).polygon_mm;
    taken.push_back(around(marks.paper));
    out.push_back(std::move(marks));
  }
  const Eigen::Vector2d middle = board.size_mm / 2;
  for (std::size_t i = 0; i < out.size(); ++i) {
    const Tag& tag = board.tags.list[i];
    TagMarks& marks = out[i];
    const Eigen::Vector2d up = (marks.paper[3] - marks.paper[0]).normalized(), right(up.y(), -up.x());
    const Eigen::Vector2d edge = (marks.paper[2] + marks.paper[3]) / 2;
    const std::vector<Eigen::Vector2d> arrow = {edge + 3 * up, edge + 0.7 * up - 1.2 * right,
                                                edge + 0.7 * up + 1.2 * right};
    if (is_free(around(arrow), i)) {
      marks.arrow = arrow;
      taken.push_back(around(arrow));
    }
    marks.number = std::to_string(tag.id);
    const Eigen::Vector2d half(words_width_mm(marks.number, kLabel_mm, true) / 2 + 0.3, kLabel_mm / 2);
    const PaperBox paper = taken[i];
    const Eigen::Vector2d reach = (paper.high - paper.low) / 2 + half + Eigen::Vector2d(0.8, 0.8);
    // The board's center has most room, so this side comes first; the arrow's side comes last.
    const double to_x = tag.center_mm.x() < middle.x() ? 1 : -1, to_y = tag.center_mm.y() < middle.y() ? 1 : -1;
    const double rise = marks.arrow.empty() ? 0 : 3.6;
    const std::array<Eigen::Vector2d, 6> tried{{{0, to_y * reach.y()},
                                                {to_x * reach.x(), 0},
                                                {0, -to_y * reach.y()},
                                                {-to_x * reach.x(), 0},
                                                {half.x() + 2, reach.y()},
                                                {0, reach.y() + rise}}};
    marks.number_mm = tag.center_mm + tried[0];
    for (const Eigen::Vector2d& d : tried) {
      const Eigen::Vector2d at = tag.center_mm + d;
      const PaperBox box{at - half, at + half};
      if (!is_free(box, taken.size())) continue;
      marks.number_mm = at;
      break;
    }
    taken.push_back({marks.number_mm - half, marks.number_mm + half});
  }
  return out;
}

void draw_tags(const TilePen& pen, const Board& board, const std::vector<TagMarks>& marks) {
  for (std::size_t i = 0; i < marks.size(); ++i) {
    const Tag& tag = board.tags.list[i];
    const TagMarks& m = marks[i];
    auto cells = black_cells(board.tags.family, tag.id, tag.size_mm);
    const double turn = tag.rotation_deg * std::numbers::pi / 180, c = std::cos(turn), s = std::sin(turn);
    for (auto& cell : cells)
      for (Eigen::Vector2d& p : cell) p = tag.center_mm + Eigen::Vector2d(c * p.x() - s * p.y(), s * p.x() + c * p.y());
    pen.outline(m.paper, {Tint::soft, 0.1, 0});
    pen.fill(cells, Tint::black);
    pen.fill({m.arrow}, Tint::ink);
    if (pen.shows(m.number_mm, kLabel_mm / 2)) pen.words(m.number_mm, m.number, kLabel_mm, Tint::ink, true);
  }
}

void draw_board(const TilePen& pen, const Board& board) {
  const Eigen::Vector2d size = board.size_mm;
  pen.outline(rectangle({0, 0}, size), {Tint::ink, 0.25, 0});
  for (const double x : {0.0, size.x()})  // extended edges, as guides for a ruler
    for (const double y : {0.0, size.y()}) {
      const double out_x = x > 0 ? 1 : -1, out_y = y > 0 ? 1 : -1;
      pen.line({x + out_x, y}, {x + out_x * (kBeyond_mm - 1), y}, {Tint::ink, 0.12, 0});
      pen.line({x, y + out_y}, {x, y + out_y * (kBeyond_mm - 1)}, {Tint::ink, 0.12, 0});
    }
  pen.outline(rectangle(board.carve_min_mm, board.carve_max_mm), {Tint::soft, 0.15, 2});
  const PaperBox seen{pen.tile.low_mm.cwiseMax(board.carve_min_mm), pen.tile.high_mm.cwiseMin(board.carve_max_mm)};
  const Eigen::Vector2d room = seen.high - seen.low;
  const std::string carved = fmt::format("carved here: {:g} x {:g} mm", (board.carve_max_mm - board.carve_min_mm).x(),
                                         (board.carve_max_mm - board.carve_min_mm).y());
  if (room.x() > words_width_mm(carved, 2.8) + 4 && room.y() > 12)
    pen.words((seen.low + seen.high) / 2, carved, 2.8, Tint::soft);
  for (const KeepOut& place : board.keep_out) {
    std::vector<Eigen::Vector2d> corners = place.polygon_mm;
    constexpr int kCorners = 72;
    for (int i = 0; corners.size() < kCorners && place.polygon_mm.empty() && i < kCorners; ++i) {
      const double a = 2 * std::numbers::pi * i / kCorners;
      corners.emplace_back(place.center_mm + place.radius_mm * Eigen::Vector2d(std::cos(a), std::sin(a)));
    }
    pen.outline(corners, {Tint::soft, 0.2, 0.8});
    const PaperBox box = around(corners);
    if (const Eigen::Vector2d at = (box.low + box.high) / 2; !place.name.empty() && pen.shows(at, 2))
      pen.words(at, place.name, 2.2, Tint::soft);
  }
  // Names of the edges, in the strip outside of them.
  const Eigen::Vector2d shown = (pen.tile.low_mm.cwiseMax(0) + pen.tile.high_mm.cwiseMin(size)) / 2;
  constexpr double kOut = 5;
  for (const auto& [at, name] : {std::pair<Eigen::Vector2d, const char*>{{shown.x(), -kOut}, "lower edge of the board"},
                                 {{shown.x(), size.y() + kOut}, "upper edge of the board"}})
    if (pen.shows(at)) pen.words(at, name, 2.4, Tint::soft);
}

// Returns crosses along the middle of every seam, clear of tags.
std::vector<Eigen::Vector2d> seam_marks(const Board& board, const Tiling& tiling, const std::vector<TagMarks>& tags) {
  constexpr double kEvery = 25, kClear = 4;
  std::vector<Eigen::Vector2d> out;
  const auto consider = [&](const Eigen::Vector2d& p) {
    for (const TagMarks& tag : tags)
      if (covers(tag.paper, p, kClear) || (p - tag.number_mm).norm() < kClear + 2) return;
    out.push_back(p);
  };
  const auto seam = [&](const Row& row, int axis) {
    const double length = board.size_mm[1 - axis];
    for (int i = 1; i < row.count; ++i) {
      const double at = row.from(i) + kOverlap_mm / 2;
      const int steps = std::max(2, static_cast<int>(std::lround(length / kEvery)));
      for (int k = 0; k < steps; ++k) {
        Eigen::Vector2d p;
        p[axis] = at;
        p[1 - axis] = length * (k + 0.5) / steps;
        consider(p);
      }
    }
  };
  seam(tiling.columns, 0);
  seam(tiling.rows, 1);
  return out;
}

void draw_seams(const TilePen& pen, const Tiling& tiling, int column, int row) {
  const Tile& tile = pen.tile;
  pen.outline(rectangle(tile.low_mm, tile.high_mm), {Tint::faint, 0.1, 0});
  const Pen middle{Tint::soft, 0.12, 1};
  const auto line = [&](int axis, double at) {
    Eigen::Vector2d a = tile.low_mm, b = tile.high_mm;
    a[axis] = b[axis] = at;
    pen.line(a, b, middle);
  };
  if (column > 0) line(0, tile.low_mm.x() + kOverlap_mm / 2);
  if (column + 1 < tiling.columns.count) line(0, tile.high_mm.x() - kOverlap_mm / 2);
  if (row > 0) line(1, tile.low_mm.y() + kOverlap_mm / 2);
  if (row + 1 < tiling.rows.count) line(1, tile.high_mm.y() - kOverlap_mm / 2);
}

// Draws a small board with all tiles, and this one filled, as it is rotated on the page.
void draw_overview(PrintedPage& page, const Board& board, const std::vector<Tile>& tiles, const Tile& tile) {
  constexpr double kWidth = 34, kHeight = 20;
  const Eigen::Vector2d size = tile.turned ? Eigen::Vector2d(board.size_mm.y(), board.size_mm.x()) : board.size_mm;
  const double scale = std::min(kWidth / size.x(), kHeight / size.y());
  const double top = page.free.low.y() - kHead_mm + 9.5;
  const Eigen::Vector2d origin(page.free.high.x() - scale * size.x(), top + scale * size.y());
  const auto at = [&](const Eigen::Vector2d& p) {
    return tile.turned ? Eigen::Vector2d(origin.x() + scale * (size.x() - p.y()), origin.y() - scale * p.x())
                       : Eigen::Vector2d(origin.x() + scale * p.x(), origin.y() - scale * p.y());
  };
  const auto inside = [&](const Tile& one) {
    return PaperBox{one.low_mm.cwiseMax(0), one.high_mm.cwiseMin(board.size_mm)};
  };
  const PaperBox here = inside(tile);
  if (tiles.size() > 1) add_rectangle(page.drawing, at(here.low), at(here.high), Tint::faint);
  for (const Tag& tag : board.tags.list) {
    std::vector<Eigen::Vector2d> corners = tag_paper(tag, board.tags.family).polygon_mm;
    for (Eigen::Vector2d& p : corners) p = at(p);
    add_polygon(page.drawing, corners, Tint::soft);
  }
  add_rectangle(page.drawing, at({0, 0}), at(board.size_mm), Tint::none, {Tint::ink, 0.2, 0});
  if (tiles.size() == 1) return;
  for (const Tile& one : tiles) {
    const PaperBox box = inside(one);
    add_rectangle(page.drawing, at(box.low), at(box.high), Tint::none, {Tint::soft, 0.1, 0});
    if (tiles.size() <= 30)
      add_words(page.drawing, {.at_mm = at((box.low + box.high) / 2),
                               .text = one.name,
                               .size_mm = 2.2,
                               .anchor = Anchor::middle,
                               .bold = one.name == tile.name,
                               .centered = true});
  }
}

std::vector<Tile> tiles_of(const Tiling& tiling, const PrintSetup& setup) {
  std::vector<Tile> out;
  const FreeArea free = free_area(setup, kHead_mm);
  // From the upper left of the board, in reading order.
  for (int r = tiling.rows.count - 1; r >= 0; --r)
    for (int c = 0; c < tiling.columns.count; ++c) {
      Tile tile;
      tile.page = out.size();
      const int letter = tiling.rows.count - 1 - r;
      tile.name = (letter < 26 ? std::string(1, static_cast<char>('A' + letter)) : fmt::format("r{}c", letter + 1)) +
                  std::to_string(c + 1);
      tile.low_mm = {tiling.columns.from(c), tiling.rows.from(r)};
      tile.high_mm = tile.low_mm + Eigen::Vector2d(tiling.columns.length, tiling.rows.length);
      tile.turned = tiling.turned;
      const Eigen::Vector2d extent = tile.high_mm - tile.low_mm;
      const double left = (free.low.x() + free.high.x()) / 2;
      tile.at_mm = tile.turned ? Eigen::Vector2d(left + extent.y() / 2, free.low.y() + extent.x())
                               : Eigen::Vector2d(left - extent.x() / 2, free.low.y() + extent.y());
      out.push_back(tile);
    }
  return out;
}

}  // namespace

TemplatePages template_pages(const Board& board, const PrintSetup& setup) {
  const Tiling tiling = tiling_of(board, setup);
  if (tiling.pages() > kMostPages)
    fail("board.json: size_mm",
         fmt::format("a board of {:g} x {:g} mm takes {} pages of {}", board.size_mm.x(), board.size_mm.y(),
                     tiling.pages(), setup.paper.name),
         "print on larger paper, or on --no-template and measure where the tags go");
  TemplatePages out;
  out.tiles = tiles_of(tiling, setup);
  const std::vector<TagMarks> tags = marks_of(board);
  const std::vector<Eigen::Vector2d> crosses = seam_marks(board, tiling, tags);
  const bool one = out.tiles.size() == 1;
  const std::string turn = tiling.turned ? " The board's upper edge is at the page's left." : "";
  for (const Tile& tile : out.tiles) {
    std::vector<std::string> lines = {
        one ? "Cut along the board's outline and lay it on the board, or cut windows for the tags. Each tag goes where "
              "its picture is, the same way round (arrow: its upper side)." +
                  turn
            : fmt::format(
                  "Tile {} of {}. Cut neighbors along the dashed line in the middle of the seam, or lay them on "
                  "each other so that the crosses meet. Each tag goes where its picture is (arrow: its upper "
                  "side).{}",
                  tile.page + 1, out.tiles.size(), turn),
    };
    PrintedPage page = new_page(setup,
                                one ? setup.name + ": where the tags go, 1:1"
                                    : fmt::format("{}: where the tags go, 1:1, tile {}", setup.name, tile.name),
                                {}, kHead_mm);
    double y = page.free.low.y() - kHead_mm + 8 + 2 * 3.4;
    constexpr double kMap = 38, kSize = 2.5;
    for (const std::string& sentence : lines)
      for (const std::string& line : wrapped(sentence, kSize, page.free.high.x() - page.free.low.x() - kMap)) {
        add_words(page.drawing, {.at_mm = {page.free.low.x() - 10, y += 3.4}, .text = line, .size_mm = kSize});
      }
    const TilePen pen{page.drawing, tile};
    const int columns = tiling.columns.count, index = static_cast<int>(tile.page);
    draw_seams(pen, tiling, index % columns, tiling.rows.count - 1 - index / columns);
    draw_board(pen, board);
    draw_tags(pen, board, tags);
    for (const Eigen::Vector2d& p : crosses)
      if (pen.shows(p, 3)) {
        const Eigen::Vector2d at = tile.on_page(p), x(3, 0), y_arm(0, 3);
        for (const Eigen::Vector2d& arm : {x, y_arm})
          add_line(page.drawing, at - arm, at + arm, {Tint::black, 0.12, 0});
        add_circle(page.drawing, at, 1.6, Tint::none, {Tint::black, 0.12, 0});
        out.marks.push_back({tile.page, p});
      }
    draw_overview(page, board, out.tiles, tile);
    out.pages.push_back(std::move(page));
  }
  return out;
}

}  // namespace burin
