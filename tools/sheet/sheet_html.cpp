#include <fmt/format.h>

#include <string>
#include <vector>

#include "burin/base/files/svg.h"
#include "embedded/sheet.h"
#include "tools/content_policy.h"
#include "tools/drawing/drawing_svg.h"
#include "tools/sheet/sheet.h"
#include "tools/version.h"

namespace burin {
namespace {

// A phone shows it 390 pixels wide. A narrow drawing with large words stays legible.
constexpr double kWidth_mm = 100, kMostHeight_mm = 110, kDrawingText_mm = 3.6;

std::string figure_of(const Sheet& sheet, Projection projection, const std::string& caption) {
  const BenchDrawing drawn = bench_drawing(sheet.board, sheet.places, projection, kWidth_mm, kMostHeight_mm,
                                           kDrawingText_mm, sheet.hang_height_mm);
  std::string told = caption + ". ";
  for (const SheetPlace& place : sheet.places)
    told += fmt::format("{} at x {:.0f}, y {:.0f}, z {:.0f} mm. ", place.name, place.at_mm.x(), place.at_mm.y(),
                        place.at_mm.z());
  return "<figure>" + drawing_svg(drawn.drawing, told) + "<figcaption>" + xml_text(caption) +
         "</figcaption></figure>\n";
}

std::string cell(const std::string& head, const std::string& text) {
  return "<td data-head=\"" + xml_text(head) + "\">" + xml_text(text) + "</td>";
}

std::string table_of(const std::vector<std::string>& heads, const std::vector<std::vector<std::string>>& rows) {
  std::string out = "<table><thead><tr>";
  for (const std::string& head : heads) out += "<th scope=\"col\">" + xml_text(head) + "</th>";
  out += "</tr></thead><tbody>\n";
  for (const auto& row : rows) {
    out += "<tr><th scope=\"row\">" + row[0] + "</th>";  // HTML; the rest is text
    for (std::size_t c = 1; c < row.size(); ++c) out += cell(heads[c], row[c]);
    out += "</tr>\n";
  }
  return out + "</tbody></table>\n";
}

std::string places_table(const std::vector<PlaceInWords>& places, const char* upright, const char* away) {
  std::vector<std::vector<std::string>> rows;
  rows.reserve(places.size());
  for (const PlaceInWords& p : places) rows.push_back({xml_text(p.name), p.across, p.upright, p.away, p.tolerance});
  return table_of({"place", "left and right", upright, away, kToleranceHead}, rows);
}

}  // namespace

std::string sheet_html(const Sheet& sheet) {
  const std::string style(embedded::sheet("sheet.css"));
  std::string body =
      "<h1>" + xml_text(sheet.name) + "</h1>\n<p class=\"lead\">" + xml_text(introduction(sheet)) + "</p>\n";
  body += "<section><h2>On a table</h2>\n<div class=\"figures\">" +
          figure_of(sheet, Projection::table_above, "From above: the board's lower edge is towards you") +
          figure_of(sheet, Projection::table_front, "From the lower edge: heights above the face") + "</div>\n" +
          places_table(on_table(sheet), "near and far", "height") + "</section>\n";
  body += "<section><h2>On a wall</h2>\n" +
          fmt::format("<p>The board's middle hangs {:.0f} mm above the floor, its lower edge at {:.0f} mm.</p>\n",
                      sheet.hang_height_mm, sheet.hang_height_mm - sheet.board.size_mm.y() / 2);
  for (const Finding& finding : findings(sheet))
    body += fmt::format("<p{}>{}.</p>\n", finding.severity == Finding::Severity::note ? "" : " class=\"warning\"",
                        xml_text(begun_as_sentence(sentence(finding))));
  body += "<div class=\"figures\">" + figure_of(sheet, Projection::wall_side, "From the left: the wall at the left") +
          figure_of(sheet, Projection::wall_above, "From above: the wall at the top") +
          figure_of(sheet, Projection::wall_front, "As you look at it") + "</div>\n" +
          places_table(on_wall(sheet), "height", "from the wall") + "</section>\n";
  body +=
      "<section><h2>Photos, in this order</h2>\n<p>" + xml_text(focus_in_words(sheet.focus)) +
      "</p>\n<p>The board lies on a table, its lower edge towards you; mm above the face, and from its edges.</p>\n";
  for (const Finding& finding : focus_findings(sheet.plan, sheet.focus))
    body += "<p class=\"warning\">" + xml_text(begun_as_sentence(sentence(finding))) + ".</p>\n";
  std::vector<std::vector<std::string>> rows;
  for (const PhotoInWords& p : photos_in_words(sheet))
    rows.push_back({"<label><input type=\"checkbox\"> " + xml_text(p.name) + "</label>", p.place, p.exposures, p.lamp});
  body += table_of({"photo", "place", "exposures", "lamp"}, rows) + "</section>\n";
  return "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n" + content_policy({}, {{style}}) +
         "\n<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
         "<meta name=\"generator\" content=\"burin " +
         version() + "\">\n<title>" + xml_text(sheet.name) + ": where to stand</title>\n<style>" + style +
         "</style></head>\n<body><main>\n" + body + "</main></body></html>\n";
}

}  // namespace burin
