// tools/drawing/drawing_svg.h - a drawing as inline SVG. Colors are classes (fill-eye, line-soft, ...), which a style
// sheet defines for light, dark and paper. Words stay text.
#pragma once

#include <string>

#include "tools/drawing/drawing.h"

namespace burin {

/// Returns the <svg> element, with one unit per mm of the drawing. `label`: alternative description for readers who
/// cannot see it.
std::string drawing_svg(const Drawing& drawing, const std::string& label);

}  // namespace burin
