// tools/drawing/drawing.h - a drawing as a list of shapes and words. It becomes a page of a PDF (tools/drawing/pdf.h)
// or SVG (tools/drawing/drawing_svg.h). Frame: mm, origin at the top left, x right, y down.
#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace burin {

/// Colors by meaning. Paper has one palette; a screen has a light and a dark one.
enum class Tint { none, black, white, ink, soft, faint, lamp, eye, reach, board };

/// Style of an outline. No outline if `tint` is none.
struct Pen {
  Tint tint = Tint::none;
  double width_mm = 0.2;
  double dash_mm = 0;  ///< 0: solid
};

/// Outlines drawn and filled as one shape, without seams between them.
struct Shape {
  std::vector<std::vector<Eigen::Vector2d>> outlines;
  bool closed = true;
  Tint fill = Tint::none;
  Pen pen;
};

enum class Anchor { start, middle, end };

struct Words {
  Eigen::Vector2d at_mm{0, 0};
  std::string text;
  double size_mm = 3;  ///< of the font
  Tint tint = Tint::ink;
  Anchor anchor = Anchor::start;
  bool bold = false;
  bool centered = false;  ///< `at_mm` is at half the height of capitals, not on the baseline
  double turn_deg = 0;    ///< counter-clockwise about `at_mm`
};

struct Drawing {
  Eigen::Vector2d size_mm{0, 0};
  std::vector<std::variant<Shape, Words>> elements;
};

void add_line(Drawing& drawing, const Eigen::Vector2d& from, const Eigen::Vector2d& to, const Pen& pen);
void add_polygon(Drawing& drawing, std::vector<Eigen::Vector2d> corners, Tint fill, const Pen& pen = {});
/// `low` and `high`: any two opposite corners.
void add_rectangle(Drawing& drawing, const Eigen::Vector2d& low, const Eigen::Vector2d& high, Tint fill,
                   const Pen& pen = {});
void add_circle(Drawing& drawing, const Eigen::Vector2d& center, double radius, Tint fill, const Pen& pen = {});
void add_words(Drawing& drawing, Words words);

/// Adds all elements of another drawing, with its top left at `at`.
void add_drawing(Drawing& drawing, const Drawing& other, const Eigen::Vector2d& at);

/// Estimates the width of the words in a sans-serif font, mm. The estimate is conservative, since fonts differ.
double words_width_mm(std::string_view text, double size_mm, bool bold = false);

/// Shortens text to the given width, mm, with ... at its end.
std::string shortened(const std::string& text, double size_mm, double width_mm, bool bold = false);

/// Wraps text into lines of at most the given width, mm; splits longer words.
std::vector<std::string> wrapped(std::string_view text, double size_mm, double width_mm);

/// Clips a convex polygon to the rectangle; empty if they do not overlap.
std::vector<Eigen::Vector2d> clipped(const std::vector<Eigen::Vector2d>& polygon, const Eigen::Vector2d& low,
                                     const Eigen::Vector2d& high);

/// Clips a line to the rectangle: two points, or none.
std::vector<Eigen::Vector2d> clipped_line(const Eigen::Vector2d& from, const Eigen::Vector2d& to,
                                          const Eigen::Vector2d& low, const Eigen::Vector2d& high);

}  // namespace burin
