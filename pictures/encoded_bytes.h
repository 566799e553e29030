// burin/pictures/encoded_bytes.h - 8-bit pictures as PNG and JPEG files in memory, for files that include fmt. Headers
// of OpenImageIO, which encoded_picture.h needs, include another version of fmt.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

namespace burin {

/// A picture's stored values: rows from the top, `channels` values per pixel (1: gray, 3: RGB).
struct EightBits {
  int width = 0, height = 0, channels = 0;
  std::span<const std::uint8_t> values;
};

/// A PNG file's bytes. Throws Error with the name of `file`, the intended output.
std::string png_bytes(const EightBits& picture, const std::filesystem::path& file);

/// A JPEG file's bytes, colors at full resolution; `quality` is libjpeg's, 1 to 100. Throws Error as png_bytes does.
std::string jpeg_bytes(const EightBits& picture, int quality, const std::filesystem::path& file);

}  // namespace burin
