#include "tools/drawing/drawing.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace burin {

void add_line(Drawing& drawing, const Eigen::Vector2d& from, const Eigen::Vector2d& to, const Pen& pen) {
  drawing.elements.emplace_back(Shape{{{from, to}}, false, Tint::none, pen});
}

void add_polygon(Drawing& drawing, std::vector<Eigen::Vector2d> corners, Tint fill, const Pen& pen) {
  drawing.elements.emplace_back(Shape{{std::move(corners)}, true, fill, pen});
}

void add_rectangle(Drawing& drawing, const Eigen::Vector2d& low, const Eigen::Vector2d& high, Tint fill,
                   const Pen& pen) {
  add_polygon(drawing, {low, {high.x(), low.y()}, high, {low.x(), high.y()}}, fill, pen);
}

void add_circle(Drawing& drawing, const Eigen::Vector2d& center, double radius, Tint fill, const Pen& pen) {
  constexpr int kCorners = 48;
  std::vector<Eigen::Vector2d> corners;
  for (int i = 0; i < kCorners; ++i) {
    const double a = 2 * std::numbers::pi * i / kCorners;
    corners.emplace_back(center + radius * Eigen::Vector2d(std::cos(a), std::sin(a)));
  }
  add_polygon(drawing, std::move(corners), fill, pen);
}

void add_words(Drawing& drawing, Words words) { drawing.elements.emplace_back(std::move(words)); }

void add_drawing(Drawing& drawing, const Drawing& other, const Eigen::Vector2d& at) {
  for (auto element : other.elements) {
    if (auto* shape = std::get_if<Shape>(&element)) {
      for (auto& outline : shape->outlines)
        for (Eigen::Vector2d& p : outline) p += at;
    } else {
      std::get<Words>(element).at_mm += at;
    }
    drawing.elements.push_back(std::move(element));
  }
}

double words_width_mm(std::string_view text, double size_mm, bool bold) {
  // Glyph widths of the widest common sans-serif font (DejaVu Sans), in em.
  double em = 0;
  for (const char c : text) {
    if ((static_cast<unsigned char>(c) & 0xC0) == 0x80) continue;  // a continuation byte
    if (std::string_view("iljI|.,:;'!()[] ").find(c) != std::string_view::npos)
      em += 0.38;
    else if (std::string_view("mwMW@%").find(c) != std::string_view::npos)
      em += 0.97;
    else
      em += 0.64;
  }
  return em * size_mm * (bold ? 1.1 : 1);
}

namespace {

// Returns the number of bytes within the width, in whole letters; at least one letter.
std::size_t bytes_within(const std::string& text, double size_mm, double width_mm, bool bold) {
  std::size_t end = 0;
  while (end < text.size()) {
    std::size_t next = end + 1;
    while (next < text.size() && (static_cast<unsigned char>(text[next]) & 0xC0) == 0x80) ++next;
    if (end > 0 && words_width_mm(text.substr(0, next), size_mm, bold) > width_mm) break;
    end = next;
  }
  return end;
}

}  // namespace

std::string shortened(const std::string& text, double size_mm, double width_mm, bool bold) {
  if (words_width_mm(text, size_mm, bold) <= width_mm) return text;
  return text.substr(0, bytes_within(text, size_mm, width_mm - words_width_mm("...", size_mm, bold), bold)) + "...";
}

std::vector<std::string> wrapped(std::string_view text, double size_mm, double width_mm) {
  std::vector<std::string> lines;
  std::string line;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find(' ', at), text.size());
    std::string word(text.substr(at, end - at));
    at = end + 1;
    if (word.empty()) continue;
    while (words_width_mm(word, size_mm) > width_mm) {
      const std::size_t cut = bytes_within(word, size_mm, width_mm, false);
      if (cut == word.size()) break;  // one letter
      if (!line.empty()) lines.push_back(line);
      line.clear();
      lines.push_back(word.substr(0, cut));
      word.erase(0, cut);
    }
    std::string longer = line;
    longer += (line.empty() ? "" : " ") + word;
    if (!line.empty() && words_width_mm(longer, size_mm) > width_mm) {
      lines.push_back(line);
      line = word;
    } else {
      line = longer;
    }
  }
  if (!line.empty()) lines.push_back(line);
  return lines;
}

std::vector<Eigen::Vector2d> clipped(const std::vector<Eigen::Vector2d>& polygon, const Eigen::Vector2d& low,
                                     const Eigen::Vector2d& high) {
  // Algorithm: Sutherland and Hodgman 1974, one side of the rectangle after the other.
  std::vector<Eigen::Vector2d> out = polygon;
  for (int axis = 0; axis < 2; ++axis)
    for (const double side : {1.0, -1.0}) {
      const double limit = side > 0 ? low[axis] : -high[axis];
      std::vector<Eigen::Vector2d> in;
      std::swap(in, out);
      for (std::size_t i = 0; i < in.size(); ++i) {
        const Eigen::Vector2d &a = in[i], &b = in[(i + 1) % in.size()];
        const double from = side * a[axis] - limit, to = side * b[axis] - limit;
        if (from >= 0) out.push_back(a);
        if ((from >= 0) != (to >= 0)) out.emplace_back(a + from / (from - to) * (b - a));
      }
    }
  return out;
}

std::vector<Eigen::Vector2d> clipped_line(const Eigen::Vector2d& from, const Eigen::Vector2d& to,
                                          const Eigen::Vector2d& low, const Eigen::Vector2d& high) {
  double first = 0, last = 1;
  const Eigen::Vector2d way = to - from;
  for (int axis = 0; axis < 2; ++axis) {
    if (way[axis] == 0) {
      if (from[axis] < low[axis] || from[axis] > high[axis]) return {};
      continue;
    }
    const double a = (low[axis] - from[axis]) / way[axis], b = (high[axis] - from[axis]) / way[axis];
    first = std::max(first, std::min(a, b));
    last = std::min(last, std::max(a, b));
  }
  if (!(first < last)) return {};
  return {from + first * way, from + last * way};
}

}  // namespace burin
