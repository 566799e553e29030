// burin/pictures/jpeg_picture.h - JPEG pictures by libjpeg itself. Include it in .cpp files only: it pulls in
// OpenImageIO.
#pragma once

#include <OpenImageIO/imageio.h>

#include <memory>

namespace burin {

/// A reader of JPEG as OpenImageIO's readers are, in the place of its own, which passes over libjpeg's warnings: those
/// that mean damage fail the row that is read. Bytes behind the end of the picture (the film of a motion photo, further
/// pictures, a maker's notes) are none of its own, and an end marker may be missing. Pixels: 8-bit gray or RGB, of
/// CMYK as OpenImageIO mixes it, read from the first row to the last once. Attributes: those of EXIF, XMP and the color
/// profile.
std::unique_ptr<OIIO::ImageInput> make_jpeg_input();

}  // namespace burin
