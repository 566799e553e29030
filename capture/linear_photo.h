// burin/capture/linear_photo.h - a photo as linear values, and how finely its file kept them.
#pragma once

#include <cstdint>
#include <vector>

#include "burin/base/image.h"

namespace burin {

/// How a file kept its values.
struct StoredAs {
  double step = 0;     ///< one stored level, in units of the full range; 0 for floating-point files
  bool srgb = false;   ///< levels lie along the sRGB curve
  bool lossy = false;  ///< JPEG
  /// Where a response of its own (burin/scene/response.h) bends that curve: linear widths of one level at the squares
  /// of i / (size - 1). Empty: it does not.
  std::vector<float> bent_steps;
};

/// A photo, linear, 1 being the white level; 1 or 3 channels.
struct LinearPhoto {
  Image value;
  std::vector<std::uint8_t>
      clipped;      ///< width * height: 1 where any channel is at (or near) the white level or unusable
  StoredAs stored;  ///< how finely the file kept the values
};

}  // namespace burin
