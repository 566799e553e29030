// burin/base/srgb.h - the curve of sRGB (IEC 61966-2-1).
#pragma once

#include <cmath>

namespace burin {

/// Stored values to light and back; 1 is white. No clipping.
inline float srgb_to_linear(float v) { return v <= 0.04045f ? v / 12.92f : std::pow((v + 0.055f) / 1.055f, 2.4f); }
inline float linear_to_srgb(float v) { return v <= 0.0031308f ? v * 12.92f : 1.055f * std::pow(v, 1 / 2.4f) - 0.055f; }

}  // namespace burin
