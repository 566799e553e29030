#include "burin/optimize/toolpath/label.h"

#include <array>

#include "burin/base/error.h"

namespace burin {
namespace {

// Corners of a digit, in its width and half its height: 0 1 at the bottom, 2 3 in the middle, 4 5 at the top.
constexpr std::array<std::array<double, 2>, 6> kCorners{{{0, 0}, {1, 0}, {0, 1}, {1, 1}, {0, 2}, {1, 2}}};
// The strokes a to g of seven-segment displays.
constexpr std::array<std::array<int, 2>, 7> kStrokes{{{4, 5}, {5, 3}, {3, 1}, {1, 0}, {0, 2}, {2, 4}, {2, 3}}};
constexpr std::array<const char*, 10> kDigits{"abcdef", "bc",     "abged", "abgcd",   "fgbc",
                                              "afgcd",  "afgcde", "abc",   "abcdefg", "abcdfg"};

std::string strokes_of(char c) {
  if (c >= '0' && c <= '9') return kDigits[static_cast<std::size_t>(c - '0')];
  if (c == '-') return "g";
  if (c == ' ') return "";
  fail("label", std::string("has no strokes for \"") + c + "\"", "write digits, hyphens and spaces");
}

}  // namespace

Scratches label_strokes(const std::string& text, const Eigen::Vector2d& at_mm, const LabelSize& size) {
  Scratches out;
  const Eigen::Vector2d cell(0.55 * size.height_mm, 0.5 * size.height_mm);
  Eigen::Vector2d left = at_mm;
  for (const char c : text) {
    for (const char stroke : strokes_of(c)) {
      const auto& [from, to] = kStrokes[static_cast<std::size_t>(stroke - 'a')];
      const auto corner = [&](int i) {
        const auto at = static_cast<std::size_t>(i);
        return Eigen::Vector2d(left + Eigen::Vector2d(kCorners[at][0], kCorners[at][1]).cwiseProduct(cell));
      };
      const Eigen::Vector2d a = corner(from), b = corner(to), off = (b - a).normalized() * size.gap_mm;
      out.x0_mm.push_back(a.x() + off.x()), out.y0_mm.push_back(a.y() + off.y());
      out.x1_mm.push_back(b.x() - off.x()), out.y1_mm.push_back(b.y() - off.y());
    }
    left.x() += label_advance_mm(size);
  }
  return out;
}

}  // namespace burin
