// burin/pictures/picture.h - pictures on disk, read and written through OpenImageIO.
#pragma once

#include <filesystem>

#include "burin/base/image.h"

namespace burin {

/// Reads a picture as stored, integers scaled to 0..1, alpha composited over white, any size, 1 or 3 channels.
/// EXIF orientation is applied (this is for target pictures; photos for calibration are read by capture/).
/// Throws Error for a file that is missing or no picture.
Image read_picture(const std::filesystem::path& file);

/// Writes a picture by its extension: .png (8 bits, or 16 if asked), .jpg, .exr and .tif (float). Atomic.
/// Values are written as they are (clamped to 0..1 for integer formats): encode before calling.
void write_picture(const Image& image, const std::filesystem::path& file, int png_bits = 8);

}  // namespace burin
