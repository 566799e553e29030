// burin/optimize/toolpath/label.h - numbers and dates as scratches: digits of seven strokes, as on a pocket calculator.
// Frame: board, mm. Strokes do not touch each other, so no rule of a machine rejects them.
#pragma once

#include <Eigen/Core>
#include <string>

#include "burin/scene/scratches.h"

namespace burin {

/// Size of the characters.
struct LabelSize {
  double height_mm = 1.8;  ///< of a digit; it is 0.55 times as wide
  double gap_mm = 0.12;    ///< distance of each end of a stroke from its corner
};

/// Distance between the left edges of neighboring characters.
inline double label_advance_mm(const LabelSize& size) { return 0.85 * size.height_mm; }

/// The shortest stroke, mm.
inline double shortest_label_stroke_mm(const LabelSize& size) { return 0.5 * size.height_mm - 2 * size.gap_mm; }

/// Strokes of a `text` of digits, hyphens and spaces, its lower-left corner at `at_mm`. Throws Error for other
/// characters.
Scratches label_strokes(const std::string& text, const Eigen::Vector2d& at_mm, const LabelSize& size);

}  // namespace burin
