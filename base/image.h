// burin/base/image.h - a picture in memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "burin/base/limits.h"
#include "burin/base/srgb.h"

namespace burin {

/// Row-major, channels interleaved, top row first. The owner documents if values are linear.
struct Image {
  int width = 0, height = 0, channels = 1;
  std::vector<float> data;

  Image() = default;
  /// An image with the same value in all pixels.
  Image(int width_px, int height_px, int channel_count, float value = 0)
      : width(width_px),
        height(height_px),
        channels(channel_count),
        data(static_cast<std::size_t>(width_px) * height_px * channel_count, value) {}

  /// The value at column x, row y, channel c; not checked.
  float& at(int x, int y, int c = 0) { return data[(static_cast<std::size_t>(y) * width + x) * channels + c]; }
  /// The value at column x, row y, channel c; not checked.
  float at(int x, int y, int c = 0) const { return data[(static_cast<std::size_t>(y) * width + x) * channels + c]; }
};

/// Throws Error unless width x height is a picture with at most `most` pixels and sides within `most_side`.
void require_picture_size(std::int64_t width, std::int64_t height, std::int64_t most, const std::string& where,
                          const std::string& kind, std::int64_t most_side = limit::kPictureSide);

/// Rec. 709 luminance of three channels (0.2126 R + 0.7152 G + 0.0722 B); one channel returns unchanged.
Image luminance(const Image& image);

/// Rec. 709 luminance of one pixel's R, G, B.
inline float luminance_of(const float* rgb) { return 0.2126f * rgb[0] + 0.7152f * rgb[1] + 0.0722f * rgb[2]; }

/// Area-averaging (down) or bilinear (up) resize.
Image resized(const Image& image, int width, int height);

}  // namespace burin
