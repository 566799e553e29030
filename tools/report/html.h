// tools/report/html.h - the pieces a report page is made of: text, pictures, tables and curves, all inside one file.
// Nothing refers to anything outside the page: pictures are inlined, there is no script.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "burin/render/image.h"

namespace burin {

/// Text as HTML: & < > " escaped.
std::string html(std::string_view text);

/// HTML as text: without tags, entities turned back.
std::string plain_text(const std::string& html);

/// A picture, values 0..1 as they are shown (already encoded), 1 or 3 channels, as a data: address. JPEG for
/// photographs, PNG for what must keep its colors and edges.
enum class PictureKind { jpeg, png };
std::string data_address(const Image& shown, PictureKind kind);

/// A picture with a caption (HTML; without its tags it is the picture's alt text), and, drawn over it, an optional SVG
/// in the picture's pixels.
std::string figure(const Image& shown, const std::string& caption_html, PictureKind kind = PictureKind::jpeg,
                   const std::string& svg_overlay = "");

/// Figures side by side, wrapping where the page is narrow; `large` ones two a row.
std::string figure_row(std::span<const std::string> figures, bool large = false);

/// A table; cells are HTML. The first column is the row's name.
struct Table {
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;
};
std::string table(const Table& table);

/// A curve over 0, 1, 2, ... as inline SVG, logarithmic in y where all values are positive and span a decade.
struct Curve {
  std::string name;
  std::vector<double> values;
};
std::string chart(std::span<const Curve> curves, const std::string& x_label, const std::string& y_label);

/// The whole page: title, a sentence that tells the outcome, points to mind, the body, and when and by what it was
/// made.
std::string page(const std::string& title, const std::string& outcome_html, std::span<const std::string> points_html,
                 const std::string& body_html);

/// A number with its uncertainty in digits that mean something: "0.0602 ± 0.0004"; without, four digits.
std::string with_sigma(double value, double sigma);
std::string number(double value);

}  // namespace burin
