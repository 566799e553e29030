// burin/pictures/heif_picture.h - HEIF pictures (HEIC, AVIF) through libheif. Include it in .cpp files only: it
// includes OpenImageIO.
#pragma once

#include <OpenImageIO/imageio.h>

#include <memory>

namespace burin {

/// Reader of HEIF's main picture with the interface of OpenImageIO's readers. It replaces OpenImageIO's own: version
/// 2.4 copies rows of the container's declared size, even from a picture that was coded smaller.
/// - By default the file's rotations and crops are applied. Sizes are those of the result, and "Orientation" is 1.
/// - With `as_the_sensor` the cropped picture stays as coded, not rotated or mirrored, and "Orientation" is EXIF's.
/// - Pixels are 8-bit RGB or RGBA, multiplied by alpha only if the file's are. They are decoded with the first row; a
/// decoder's warning is an error.
/// - Attributes are those of its EXIF.
std::unique_ptr<OIIO::ImageInput> make_heif_input(bool as_the_sensor);

}  // namespace burin
