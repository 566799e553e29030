#include "burin/base/files/svg.h"

#include "burin/base/files/decimals.h"

namespace burin {
namespace {

std::string attribute(std::string_view name, std::string_view value) {
  return " " + std::string(name) + "=\"" + std::string(value) + "\"";
}

// Attributes after others: with a leading space, if there are any.
std::string after_space(std::string_view attributes) { return attributes.empty() ? "" : " " + std::string(attributes); }

std::string poly(const std::string& element, std::span<const Eigen::Vector2d> points, std::string_view attributes) {
  std::string places;
  for (const Eigen::Vector2d& p : points)
    places += (places.empty() ? "" : " ") + fixed(p.x(), 1) + "," + fixed(p.y(), 1);
  return "<" + element + attribute("points", places) + after_space(attributes) + "/>\n";
}

}  // namespace

std::string xml_text(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  for (const char c : text) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '"')
      out += "&quot;";
    else
      out += c;
  }
  return out;
}

std::string svg_line(const Eigen::Vector2d& from, const Eigen::Vector2d& to, std::string_view attributes,
                     int decimals) {
  return "<line" + attribute("x1", fixed(from.x(), decimals)) + attribute("y1", fixed(from.y(), decimals)) +
         attribute("x2", fixed(to.x(), decimals)) + attribute("y2", fixed(to.y(), decimals)) + after_space(attributes) +
         "/>\n";
}

std::string svg_polyline(std::span<const Eigen::Vector2d> points, std::string_view attributes) {
  return poly("polyline", points, attributes);
}

std::string svg_polygon(std::span<const Eigen::Vector2d> points, std::string_view attributes) {
  return poly("polygon", points, attributes);
}

std::string svg_words(const Eigen::Vector2d& at, std::string_view words, std::string_view anchor,
                      std::string_view attributes) {
  return "<text" + attribute("x", fixed(at.x(), 1)) + attribute("y", fixed(at.y(), 1)) +
         attribute("text-anchor", anchor) + after_space(attributes) + ">" + xml_text(words) + "</text>\n";
}

std::string svg_drawing(const Eigen::Vector2d& size, std::string_view attributes, std::string_view elements) {
  return "<svg" + attribute("xmlns", "http://www.w3.org/2000/svg") + after_space(attributes) +
         attribute("viewBox", "0 0 " + shortest(size.x()) + " " + shortest(size.y())) + ">\n" + std::string(elements) +
         "</svg>\n";
}

}  // namespace burin
