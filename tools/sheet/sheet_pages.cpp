#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "tools/sheet/sheet.h"

namespace burin {
namespace {

constexpr double kMargin_mm = 14, kText_mm = 2.9, kLine_mm = 3.9;

// Fills pages from the top and begins a new one when one is full.
struct PageWriter {
  Eigen::Vector2d paper_mm;
  std::string name;
  std::vector<Drawing> pages{};
  double y = 0;

  double width() const { return paper_mm.x() - 2 * kMargin_mm; }
  double left_over() const { return paper_mm.y() - kMargin_mm - y; }
  Drawing& page() { return pages.back(); }

  void begin(const std::string& title) {
    pages.push_back({paper_mm, {}});
    add_words(page(), {.at_mm = {kMargin_mm, kMargin_mm + 5},
                       .text = shortened(title, 5.6, width(), true),
                       .size_mm = 5.6,
                       .bold = true});
    add_words(page(), {.at_mm = {paper_mm.x() - kMargin_mm, paper_mm.y() - 7},
                       .text = fmt::format("{}, page {}", shortened(name, 2.4, width() / 2), pages.size()),
                       .size_mm = 2.4,
                       .tint = Tint::soft,
                       .anchor = Anchor::end});
    y = kMargin_mm + 9;
  }
  void paragraph(const std::string& text, Tint tint = Tint::ink) {
    for (const std::string& line : wrapped(text, kText_mm, width())) {
      y += kLine_mm;
      add_words(page(), {.at_mm = {kMargin_mm, y}, .text = line, .size_mm = kText_mm, .tint = tint});
    }
    y += 1.5;
  }
  void heading(const std::string& text) {
    y += 6;
    add_words(page(), {.at_mm = {kMargin_mm, y}, .text = text, .size_mm = 3.6, .bold = true});
    y += 2;
  }
  // `beside_mm`: height of the content next to it.
  void drawing(const BenchDrawing& drawn, double beside_mm = 0) {
    add_drawing(page(), drawn.drawing, {kMargin_mm, y});
    y += std::max(drawn.drawing.size_mm.y(), beside_mm);
  }
};

struct Column {
  std::string head;
  double share;  // of the width
};

// `tick`: an empty box before each row. The table continues under the title on a new page.
void add_table(PageWriter& writer, const std::vector<Column>& columns,
               const std::vector<std::vector<std::string>>& rows, bool tick, const std::string& title) {
  const double tick_mm = tick ? 6 : 0, width = writer.width() - tick_mm;
  const auto left_of = [&](std::size_t c) {
    double x = kMargin_mm + tick_mm;
    for (std::size_t i = 0; i < c; ++i) x += columns[i].share * width;
    return x;
  };
  const auto head = [&] {
    constexpr double kHead_mm = 2.5, kNext_mm = 3.2;
    writer.y += kLine_mm;
    std::size_t most = 1;
    for (std::size_t c = 0; c < columns.size(); ++c) {
      const std::vector<std::string> lines = wrapped(columns[c].head, kHead_mm, columns[c].share * width);
      most = std::max(most, lines.size());
      for (std::size_t i = 0; i < lines.size(); ++i)
        add_words(writer.page(), {.at_mm = {left_of(c), writer.y + kNext_mm * static_cast<double>(i)},
                                  .text = lines[i],
                                  .size_mm = kHead_mm,
                                  .tint = Tint::soft});
    }
    writer.y += kNext_mm * static_cast<double>(most) - 1.6;
  };
  head();
  constexpr double kNarrower = 1.12;  // words need less than the conservative words_width_mm()
  for (const auto& row : rows) {
    std::vector<std::vector<std::string>> lines;
    std::size_t most = 1;
    for (std::size_t c = 0; c < columns.size(); ++c) {
      const double column_mm = columns[c].share * width - 3;
      lines.push_back(
          wrapped(row[c], kText_mm, c == 0 ? column_mm / kNarrower : kNarrower * column_mm));  // the first is bold
      most = std::max(most, lines.back().size());
    }
    const double height = kLine_mm * static_cast<double>(most) + 2.6;
    if (height > writer.left_over()) {
      writer.begin(title + ", continued");
      head();
    }
    add_line(writer.page(), {kMargin_mm, writer.y}, {kMargin_mm + writer.width(), writer.y}, {Tint::faint, 0.15, 0});
    const double top = writer.y + 0.8;
    if (tick)
      add_rectangle(writer.page(), {kMargin_mm, top + 0.4}, {kMargin_mm + 3.4, top + 3.8}, Tint::none,
                    {Tint::ink, 0.25, 0});
    for (std::size_t c = 0; c < columns.size(); ++c)
      for (std::size_t i = 0; i < lines[c].size(); ++i)
        add_words(writer.page(), {.at_mm = {left_of(c), top + kLine_mm * static_cast<double>(i) + 2.9},
                                  .text = lines[c][i],
                                  .size_mm = kText_mm,
                                  .bold = c == 0});
    writer.y += height;
  }
}

void add_places(PageWriter& writer, const std::vector<PlaceInWords>& places, const char* upright, const char* away,
                const std::string& title) {
  std::vector<std::vector<std::string>> rows;
  rows.reserve(places.size());
  for (const PlaceInWords& p : places) rows.push_back({p.name, p.across, p.upright, p.away, p.tolerance});
  add_table(writer, {{"", 0.19}, {"left and right", 0.21}, {upright, 0.21}, {away, 0.19}, {kToleranceHead, 0.2}}, rows,
            false, title);
}

}  // namespace

std::vector<Drawing> sheet_pages(const Sheet& sheet, const Eigen::Vector2d& paper_mm) {
  PageWriter writer{paper_mm, sheet.name};
  // leaves room for the page's own title
  const std::string name = shortened(sheet.name, 5.6, writer.width() / 2, true);
  // Reserves the approximate height of the table of places; without enough room, it gets a page of its own.
  const double table_mm = 18 + 10.4 * static_cast<double>(sheet.places.size());
  bool own_page = false;
  const auto room_for_drawings = [&] {
    constexpr double kHeadings_mm = 44, kLeast_mm = 100;
    const double room = writer.left_over() - kHeadings_mm;
    own_page = room - table_mm < kLeast_mm;
    return own_page ? std::max(room, kLeast_mm) : room - table_mm;
  };
  const auto draw = [&](Projection projection, double most_height, double share = 1) {
    return bench_drawing(sheet.board, sheet.places, projection, share * writer.width(), most_height, 3.2,
                         sheet.hang_height_mm);
  };

  const std::string on_a_table = name + ": on a table";
  writer.begin(on_a_table);
  writer.paragraph(introduction(sheet));
  const double table_room = room_for_drawings();
  writer.heading("From above: the board's lower edge is towards you");
  const BenchDrawing above = draw(Projection::table_above, 0.6 * table_room);
  writer.drawing(above);
  writer.heading("From the lower edge: heights above the face");
  writer.drawing(draw(Projection::table_front, std::max(0.4 * table_room, table_room - above.drawing.size_mm.y())));
  writer.y += 3;
  if (own_page || table_mm > writer.left_over()) writer.begin(on_a_table + ", places");
  add_places(writer, on_table(sheet), "near and far", "height", on_a_table);

  const std::string on_a_wall = name + ": on a wall";
  writer.begin(on_a_wall);
  writer.paragraph(fmt::format("The board's middle hangs {:.0f} mm above the floor, its lower edge at {:.0f} mm.",
                               sheet.hang_height_mm, sheet.hang_height_mm - sheet.board.size_mm.y() / 2));
  for (const Finding& finding : findings(sheet)) writer.paragraph(begun_as_sentence(sentence(finding)) + ".");
  const double wall_room = room_for_drawings(), gap = 0.03;
  writer.heading("From the left: the wall at the left; and as you look at it");
  const BenchDrawing side = draw(Projection::wall_side, 0.55 * wall_room, (1 - gap) / 2),
                     front = draw(Projection::wall_front, 0.55 * wall_room, (1 - gap) / 2);
  add_drawing(writer.page(), front.drawing, {kMargin_mm + (1 + gap) / 2 * writer.width(), writer.y});
  writer.drawing(side, front.drawing.size_mm.y());
  writer.heading("From above: the wall at the top");
  writer.drawing(draw(Projection::wall_above, 0.45 * wall_room));
  writer.y += 3;
  if (own_page || table_mm > writer.left_over()) writer.begin(on_a_wall + ", places");
  add_places(writer, on_wall(sheet), "height", "from the wall", on_a_wall);

  const std::string photos = name + ": photos, in this order";
  writer.begin(photos);
  writer.paragraph(focus_in_words(sheet.focus));
  writer.paragraph("The board lies on a table, its lower edge towards you; mm above the face, and from its edges.");
  for (const Finding& finding : focus_findings(sheet.plan, sheet.focus))
    writer.paragraph(begun_as_sentence(sentence(finding)) + ".", Tint::soft);
  std::vector<std::vector<std::string>> rows;
  for (const PhotoInWords& p : photos_in_words(sheet)) rows.push_back({p.name, p.place, p.exposures, p.lamp});
  add_table(writer, {{"photo", 0.19}, {"place", 0.44}, {"exposures", 0.26}, {"lamp", 0.11}}, rows, true, photos);
  return std::move(writer.pages);
}

}  // namespace burin
