#include "tools/drawing/pdf.h"

#include <cairo-pdf.h>
#include <cairo.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <numbers>
#include <utility>

#include "burin/base/error.h"
#include "tools/version.h"

namespace burin {
namespace {

constexpr double kPointsPerMm = 72 / 25.4;

// Replaces invalid UTF-8, which a folder's name may contain: it would make the whole page fail.
std::string as_utf8(const std::string& text) {
  std::string out;
  for (std::size_t i = 0; i < text.size();) {
    const auto c = static_cast<unsigned char>(text[i]);
    const std::size_t length = c < 0x80 ? 1 : c >= 0xC2 && c < 0xE0 ? 2 : c >= 0xE0 && c < 0xF0 ? 3 : c < 0xF5 ? 4 : 0;
    bool good = length > 0 && (c < 0x80 || c >= 0xC2) && i + length <= text.size();
    for (std::size_t k = 1; good && k < length; ++k) good = (static_cast<unsigned char>(text[i + k]) & 0xC0) == 0x80;
    if (good)
      out += text.substr(i, length);
    else
      out += '?';
    i += good ? length : 1;
  }
  return out;
}

void set_color(cairo_t* cairo, Tint tint) {
  const auto rgb = [&](int r, int g, int b) { cairo_set_source_rgb(cairo, r / 255.0, g / 255.0, b / 255.0); };
  switch (tint) {
    case Tint::none:
    case Tint::black:
      return rgb(0, 0, 0);
    case Tint::white:
      return rgb(255, 255, 255);
    case Tint::ink:
      return rgb(31, 35, 40);
    case Tint::soft:
      return rgb(95, 104, 114);
    case Tint::faint:
      return rgb(200, 205, 211);
    case Tint::lamp:
      return rgb(166, 108, 0);
    case Tint::eye:
      return rgb(9, 92, 194);
    case Tint::reach:
      return rgb(210, 226, 247);
    case Tint::board:
      return rgb(226, 230, 235);
  }
}

void draw(cairo_t* cairo, const Shape& shape) {
  cairo_new_path(cairo);
  for (const auto& outline : shape.outlines) {
    if (outline.empty()) continue;
    cairo_move_to(cairo, outline[0].x(), outline[0].y());
    for (std::size_t i = 1; i < outline.size(); ++i) cairo_line_to(cairo, outline[i].x(), outline[i].y());
    if (shape.closed) cairo_close_path(cairo);
  }
  if (shape.fill != Tint::none) {
    set_color(cairo, shape.fill);
    cairo_fill_preserve(cairo);
  }
  if (shape.pen.tint != Tint::none) {
    set_color(cairo, shape.pen.tint);
    cairo_set_line_width(cairo, shape.pen.width_mm);
    cairo_set_dash(cairo, &shape.pen.dash_mm, shape.pen.dash_mm > 0 ? 1 : 0, 0);
    cairo_stroke_preserve(cairo);
  }
  cairo_new_path(cairo);
}

void draw(cairo_t* cairo, const Words& words) {
  const std::string text = as_utf8(words.text);
  // Without any font, cairo draws its own letters.
  cairo_select_font_face(cairo, "sans-serif", CAIRO_FONT_SLANT_NORMAL,
                         words.bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(cairo, words.size_mm);
  cairo_text_extents_t extents;
  cairo_text_extents(cairo, text.c_str(), &extents);
  const double share = words.anchor == Anchor::start ? 0 : words.anchor == Anchor::middle ? 0.5 : 1;
  constexpr double kHalfCapital = 0.36;  // em
  cairo_save(cairo);
  cairo_translate(cairo, words.at_mm.x(), words.at_mm.y());
  cairo_rotate(cairo, -words.turn_deg * std::numbers::pi / 180);
  cairo_move_to(cairo, -share * extents.x_advance, words.centered ? kHalfCapital * words.size_mm : 0);
  set_color(cairo, words.tint);
  cairo_show_text(cairo, text.c_str());
  cairo_restore(cairo);
}

cairo_status_t append(void* out, const unsigned char* data, unsigned int length) {
  static_cast<std::string*>(out)->append(reinterpret_cast<const char*>(data), length);
  return CAIRO_STATUS_SUCCESS;
}

// Returns the dictionary of object `number`, with its brackets; empty if there is none.
std::string dictionary_of(const std::string& bytes, const std::string& number) {
  const std::size_t object = bytes.find("\n" + number + " 0 obj"), from = bytes.find("<<", object),
                    to = bytes.find("endobj", object);
  if (object == std::string::npos || from == std::string::npos || to == std::string::npos || from > to) return "";
  return bytes.substr(from, bytes.rfind(">>", to) + 2 - from);
}

// Cairo has no function for viewer preferences. They are appended as an incremental update of the PDF (ISO 32000-1,
// 7.5.6): the extended catalog and its offset.
std::string with_true_size(std::string bytes) {
  const std::size_t start = bytes.rfind("startxref"), trailer = bytes.rfind("trailer"),
                    root = bytes.find("/Root ", trailer);
  std::string catalog, number;
  if (start != std::string::npos && trailer != std::string::npos && root != std::string::npos) {
    number = bytes.substr(root + 6, bytes.find(' ', root + 6) - root - 6);
    catalog = dictionary_of(bytes, number);
  }
  if (catalog.empty())
    fail("the PDF", "cairo wrote it without a table of its objects", "check that Debian's own libcairo2 is installed");
  const std::size_t from = bytes.find("<<", trailer);
  std::string settings = bytes.substr(from, bytes.rfind(">>", start) - from);
  settings += fmt::format("/Prev {}\n>>\n", std::stoul(bytes.substr(start + 9)));
  catalog.resize(catalog.size() - 2);
  if (bytes.back() != '\n') bytes += '\n';
  const std::size_t object = bytes.size();
  bytes += number + " 0 obj\n" + catalog + "/Version /1.6\n/ViewerPreferences << /PrintScaling /None >>\n>>\nendobj\n";
  const std::size_t table = bytes.size();
  return bytes +
         fmt::format("xref\n{} 1\n{:010} 00000 n \ntrailer\n{}startxref\n{}\n%%EOF\n", number, object, settings, table);
}

void require_good(cairo_status_t status, const std::string& title) {
  if (status != CAIRO_STATUS_SUCCESS)
    fail(title, std::string("cannot be drawn by cairo: \"") + cairo_status_to_string(status) + "\"",
         "check that Debian's own libcairo2 is installed");
}

}  // namespace

std::string pdf(std::span<const Drawing> pages, const PdfPaper& paper) {
  std::string bytes;
  const std::unique_ptr<cairo_surface_t, decltype(&cairo_surface_destroy)> surface(
      cairo_pdf_surface_create_for_stream(append, &bytes, paper.size_mm.x() * kPointsPerMm,
                                          paper.size_mm.y() * kPointsPerMm),
      cairo_surface_destroy);
  cairo_pdf_surface_restrict_to_version(surface.get(), CAIRO_PDF_VERSION_1_4);
  cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_TITLE, as_utf8(paper.title).c_str());
  cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_CREATOR, ("burin " + version()).c_str());
  // The present date would make every file different.
  cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_CREATE_DATE, "2000-01-01T00:00:00Z");
  const std::unique_ptr<cairo_t, decltype(&cairo_destroy)> cairo(cairo_create(surface.get()), cairo_destroy);
  cairo_scale(cairo.get(), kPointsPerMm * paper.stretch.x(), kPointsPerMm * paper.stretch.y());
  for (const Drawing& page : pages) {
    for (const auto& element : page.elements) std::visit([&](const auto& one) { draw(cairo.get(), one); }, element);
    cairo_show_page(cairo.get());
  }
  require_good(cairo_status(cairo.get()), paper.title);
  cairo_surface_finish(surface.get());
  require_good(cairo_surface_status(surface.get()), paper.title);
  return paper.true_size ? with_true_size(std::move(bytes)) : bytes;
}

Image drawn(const Drawing& drawing, double px_per_mm) {
  const auto side = [&](double mm) { return std::max(1, static_cast<int>(std::lround(mm * px_per_mm))); };
  Image out(side(drawing.size_mm.x()), side(drawing.size_mm.y()), 1);
  const std::unique_ptr<cairo_surface_t, decltype(&cairo_surface_destroy)> surface(
      cairo_image_surface_create(CAIRO_FORMAT_RGB24, out.width, out.height), cairo_surface_destroy);
  const std::unique_ptr<cairo_t, decltype(&cairo_destroy)> cairo(cairo_create(surface.get()), cairo_destroy);
  cairo_scale(cairo.get(), px_per_mm, px_per_mm);
  for (const auto& element : drawing.elements) std::visit([&](const auto& one) { draw(cairo.get(), one); }, element);
  require_good(cairo_status(cairo.get()), "a label");
  cairo_surface_flush(surface.get());
  const unsigned char* bytes = cairo_image_surface_get_data(surface.get());
  const int stride = cairo_image_surface_get_stride(surface.get());
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x) {
      std::uint32_t pixel = 0;
      std::memcpy(&pixel, bytes + static_cast<std::ptrdiff_t>(y) * stride + 4 * x, sizeof pixel);
      out.at(x, y) = static_cast<float>((pixel >> 8U) & 0xFFU) / 255;  // the image is gray, so green is enough
    }
  return out;
}

}  // namespace burin
