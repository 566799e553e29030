#include "tools/drawing/drawing_svg.h"

#include <fmt/format.h>

#include "burin/base/files/svg.h"

namespace burin {
namespace {

const char* name_of(Tint tint) {
  switch (tint) {
    case Tint::none:
      return "none";
    case Tint::black:
      return "black";
    case Tint::white:
      return "white";
    case Tint::ink:
      return "ink";
    case Tint::soft:
      return "soft";
    case Tint::faint:
      return "faint";
    case Tint::lamp:
      return "lamp";
    case Tint::eye:
      return "eye";
    case Tint::reach:
      return "reach";
    case Tint::board:
      return "board";
  }
  return "ink";
}

std::string element(const Shape& shape) {
  std::string path;
  for (const auto& outline : shape.outlines) {
    for (std::size_t i = 0; i < outline.size(); ++i)
      path += fmt::format("{}{:.2f} {:.2f}", i == 0 ? "M" : "L", outline[i].x(), outline[i].y());
    if (shape.closed) path += "Z";
  }
  std::string attributes = fmt::format("class=\"fill-{} line-{}\"", name_of(shape.fill), name_of(shape.pen.tint));
  if (shape.pen.tint != Tint::none) attributes += fmt::format(" stroke-width=\"{:.2f}\"", shape.pen.width_mm);
  if (shape.pen.dash_mm > 0) attributes += fmt::format(" stroke-dasharray=\"{:.2f}\"", shape.pen.dash_mm);
  return "<path " + attributes + " d=\"" + path + "\"/>\n";
}

std::string element(const Words& words) {
  const char* anchor = words.anchor == Anchor::start ? "start" : words.anchor == Anchor::middle ? "middle" : "end";
  std::string more;
  if (words.bold) more += " font-weight=\"600\"";
  if (words.centered) more += " dy=\"0.36em\"";
  if (words.turn_deg != 0)
    more +=
        fmt::format(" transform=\"rotate({:.1f} {:.2f} {:.2f})\"", -words.turn_deg, words.at_mm.x(), words.at_mm.y());
  return fmt::format(
      "<text class=\"fill-{}\" x=\"{:.2f}\" y=\"{:.2f}\" font-size=\"{:.2f}\" text-anchor=\"{}\"{}>{}</text>\n",
      name_of(words.tint), words.at_mm.x(), words.at_mm.y(), words.size_mm, anchor, more, xml_text(words.text));
}

}  // namespace

std::string drawing_svg(const Drawing& drawing, const std::string& label) {
  std::string out = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" role=\"img\" aria-label=\"{}\" viewBox=\"0 0 {:.2f} {:.2f}\">\n",
      xml_text(label), drawing.size_mm.x(), drawing.size_mm.y());
  for (const auto& one : drawing.elements) out += std::visit([](const auto& e) { return element(e); }, one);
  return out + "</svg>\n";
}

}  // namespace burin
