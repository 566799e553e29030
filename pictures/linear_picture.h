// burin/pictures/linear_picture.h - a picture on disk as light: what a design aims at.
#pragma once

#include <filesystem>
#include <optional>

#include "burin/base/image.h"

namespace burin {

/// Reads a picture (read_picture, burin/base/image.h) as one channel of linear light: luminance of Rec. 709
/// (0.2126 R + 0.7152 G + 0.0722 B), values decoded from sRGB but for .exr and .hdr, which are linear. It takes a third
/// of the memory of the picture in color. Throws Error as read_picture does.
Image read_linear_luminance(const std::filesystem::path& file);

/// The same in color: one channel or three of linear light. A picture of more than 64 million pixels is averaged over
/// squares of whole pixels, its longer side staying above 4096.
Image read_linear_picture(const std::filesystem::path& file);

/// Reads a picture as read_picture does; one of more than 64 million pixels is averaged over squares of whole pixels
/// while it is read, as far as its longer side stays above `longest_px`. `width` and `height` become those of the file,
/// upright. Throws Error as read_picture does.
Image read_large_picture(const std::filesystem::path& file, int longest_px, int& width, int& height);

/// The same with what is see-through over black, not over white; nothing for a picture without an alpha channel.
std::optional<Image> read_large_picture_on_black(const std::filesystem::path& file, int longest_px);

}  // namespace burin
