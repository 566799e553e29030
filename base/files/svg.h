// burin/base/files/svg.h - elements of drawings as SVG text: one line per element, for concatenation.
// Frame: SVG's, x right and y down, in the drawing's own units. Coordinates have one decimal by default. `attributes`
// enter the element unchanged: stroke="#ccc" stroke-width="2".
#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <string_view>

namespace burin {

/// Text for XML and HTML: & < > " escaped.
std::string xml_text(std::string_view text);

std::string svg_line(const Eigen::Vector2d& from, const Eigen::Vector2d& to, std::string_view attributes,
                     int decimals = 1);
std::string svg_polyline(std::span<const Eigen::Vector2d> points, std::string_view attributes);
std::string svg_polygon(std::span<const Eigen::Vector2d> points, std::string_view attributes);

/// The function escapes `words`. `anchor` is the part of them at `at`: start, middle or end.
std::string svg_words(const Eigen::Vector2d& at, std::string_view words, std::string_view anchor,
                      std::string_view attributes = "");

/// A whole drawing, (0, 0) to `size`.
std::string svg_drawing(const Eigen::Vector2d& size, std::string_view attributes, std::string_view elements);

}  // namespace burin
