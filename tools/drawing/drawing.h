// tools/drawing/drawing.h - a drawing as a list of shapes and words, made once and written as a page of a PDF
// (tools/drawing/pdf.h) or as SVG (tools/drawing/drawing_svg.h). Frame: mm, origin at the top left, x right, y down.
#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace burin {

/// Colors by what they stand for: paper has one palette, a screen has one for light and one for dark.
enum class Tint { none, black, white, ink, soft, faint, lamp, eye, reach, board };

/// How an outline is drawn. Nothing where `tint` is none.
struct Pen {
  Tint tint = Tint::none;
  double width_mm = 0.2;
  double dash_mm = 0;  ///< 0: solid
};

/// Outlines drawn and filled as one (where they touch there is no seam).
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

/// All of another drawing, its top left at `at`.
void add_drawing(Drawing& drawing, const Drawing& other, const Eigen::Vector2d& at);

/// About how long the words become in a sans-serif font, mm: on the safe side, since fonts differ.
double words_width_mm(std::string_view text, double size_mm, bool bold = false);

/// The text, its end left out (...) where it is longer than that, mm.
std::string shortened(const std::string& text, double size_mm, double width_mm, bool bold = false);

/// The text cut to words that are at most so long together, mm, a line each; a word that is longer is cut.
std::vector<std::string> wrapped(std::string_view text, double size_mm, double width_mm);

/// What of a convex polygon lies within the rectangle; empty if nothing does.
std::vector<Eigen::Vector2d> clipped(const std::vector<Eigen::Vector2d>& polygon, const Eigen::Vector2d& low,
                                     const Eigen::Vector2d& high);

/// What of a line lies within the rectangle: two points, or none.
std::vector<Eigen::Vector2d> clipped_line(const Eigen::Vector2d& from, const Eigen::Vector2d& to,
                                          const Eigen::Vector2d& low, const Eigen::Vector2d& high);

}  // namespace burin
