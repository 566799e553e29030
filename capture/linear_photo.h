// burin/capture/linear_photo.h - a photo as linear values, and the resolution of the stored ones.
#pragma once

#include <cstdint>
#include <vector>

#include "burin/base/image.h"

namespace burin {

/// Quantization of a file's values.
struct StoredAs {
  double step = 0;     ///< one stored level, in units of the full range; 0 for floating-point files
  bool srgb = false;   ///< levels follow the sRGB curve
  bool lossy = false;  ///< JPEG
  /// Linear widths of one level at the squares of i / (size - 1), if a response (burin/scene/response.h) bends that
  /// curve. Empty: no response.
  std::vector<float> bent_steps;
};

/// A linear photo, 1 being the white level; 1 or 3 channels.
struct LinearPhoto {
  Image value;
  /// Pixel mask of width * height: 1 where any channel is at (or near) the white level or unusable
  std::vector<std::uint8_t> clipped;
  StoredAs stored;  ///< quantization of the file's values
};

}  // namespace burin
