// burin/pictures/heif_picture.h - HEIF pictures (HEIC, AVIF) by libheif itself. Include it in .cpp files only: it
// pulls in OpenImageIO.
#pragma once

#include <OpenImageIO/imageio.h>

#include <memory>

namespace burin {

/// A reader of HEIF's main picture as OpenImageIO's readers are, in the place of its own: that of OpenImageIO 2.4
/// copies rows of the width and height that the container names, from a picture that may have been coded smaller. Sizes
/// are those after the turns and crops that the file asks for, which are carried out, and "Orientation" is 1; or, with
/// `as_the_sensor`, of the cropped picture as it was coded, not turned or mirrored, and "Orientation" is EXIF's. Pixels
/// are 8-bit RGB or RGBA (not multiplied by alpha where the file's are not), decoded when the first row is read; a
/// decoder's warning fails it. Attributes: those of its EXIF.
std::unique_ptr<OIIO::ImageInput> make_heif_input(bool as_the_sensor);

}  // namespace burin
