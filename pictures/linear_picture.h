// burin/pictures/linear_picture.h - a picture on disk as linear light: the target of a design.
#pragma once

#include <filesystem>
#include <optional>

#include "burin/base/image.h"

namespace burin {

/// Reads a picture (read_picture, burin/base/image.h) as one channel of linear light: luminance of Rec. 709 (0.2126 R +
/// 0.7152 G + 0.0722 B). Values are decoded from sRGB, except .exr and .hdr, which are linear. It needs a third of the
/// memory of the picture in color. Throws Error as read_picture does.
Image read_linear_luminance(const std::filesystem::path& file);

/// Reads a picture as one or three channels of linear light. A picture of more than 64 million pixels is averaged over
/// squares of whole pixels; its longer side stays above 4096.
Image read_linear_picture(const std::filesystem::path& file);

/// Reads a picture as read_picture does. A picture of more than 64 million pixels is averaged over squares of whole
/// pixels during reading, while its longer side stays above `longest_px`. `width` and `height` return the size of the
/// file, upright. Throws Error as read_picture does.
Image read_large_picture(const std::filesystem::path& file, int longest_px, int& width, int& height);

/// read_large_picture() with transparent parts over black, not over white; empty for a picture without an alpha
/// channel.
std::optional<Image> read_large_picture_on_black(const std::filesystem::path& file, int longest_px);

}  // namespace burin
