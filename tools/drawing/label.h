// tools/drawing/label.h - a line of words as a picture, to stand above another one.
#pragma once

#include <string>

#include "burin/base/image.h"

namespace burin {

inline constexpr int kLabelPx = 24;  ///< its height

/// Light words on dark gray, one channel, so many pixels wide; words that are longer end in "...". Throws Error where
/// cairo cannot draw.
Image label(const std::string& words, int width_px);

}  // namespace burin
