// burin/pictures/jpeg_picture.h - JPEG pictures through libjpeg. Include it in .cpp files only: it includes
// OpenImageIO.
#pragma once

#include <OpenImageIO/imageio.h>

#include <memory>

namespace burin {

/// Reader of JPEG with the interface of OpenImageIO's readers. It replaces OpenImageIO's own, which ignores libjpeg's
/// warnings: here warnings of damage make the row fail. Bytes after the end of the picture (the film of a motion photo,
/// further pictures, a maker's notes) are ignored, and an end marker may be missing. Pixels: 8-bit gray or RGB, with
/// CMYK converted as in OpenImageIO. Rows can be read once, from first to last. Attributes: EXIF, XMP and the color
/// profile.
std::unique_ptr<OIIO::ImageInput> make_jpeg_input();

}  // namespace burin
