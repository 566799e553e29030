// burin/pictures/picture.h - pictures on disk, read and written through OpenImageIO.
#pragma once

#include <filesystem>

#include "burin/base/image.h"

namespace burin {

/// Reads a picture as stored: integers scaled to 0..1, alpha composited over white, any size, 1 or 3 channels. Applies
/// the EXIF orientation (for target pictures; capture/ reads photos for calibration). Throws Error for a missing file
/// or one that is no picture.
Image read_picture(const std::filesystem::path& file);

/// Writes a picture in the format of its extension: .png (8 bits, or 16), .jpg, .exr and .tif (float). Atomic. Values
/// are written unchanged (clamped to 0..1 for integer formats): encode before the call.
void write_picture(const Image& image, const std::filesystem::path& file, int png_bits = 8);

}  // namespace burin
