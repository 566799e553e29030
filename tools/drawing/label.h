// tools/drawing/label.h - a line of text as an image, for a place above another image.
#pragma once

#include <string>

#include "burin/base/image.h"

namespace burin {

inline constexpr int kLabelPx = 24;  ///< height

/// Draws light text on dark gray, one channel, `width_px` wide; longer text ends in "...". Throws Error if cairo fails.
Image label(const std::string& words, int width_px);

}  // namespace burin
