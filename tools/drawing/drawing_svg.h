// tools/drawing/drawing_svg.h - a drawing as inline SVG. Colors are classes (fill-eye, line-soft, ...), so that a style
// sheet gives them for light, dark and paper; words stay words.
#pragma once

#include <string>

#include "tools/drawing/drawing.h"

namespace burin {

/// The <svg> element; one unit is a mm of the drawing. `label` is what it shows, for those who cannot see it.
std::string drawing_svg(const Drawing& drawing, const std::string& label);

}  // namespace burin
