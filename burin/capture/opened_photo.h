// burin/capture/opened_photo.h - a photo opened once for what the camera noted and for its pixels: the library of HEIC
// decodes all of them before it tells anything. Include it in .cpp files only: it pulls in OpenImageIO.
#pragma once

#include <OpenImageIO/imageio.h>

#include <filesystem>
#include <memory>

namespace burin {

struct Exif;         // burin/capture/exif.h
struct Photo;        // burin/capture/session.h
struct LinearPhoto;  // burin/capture/linear_photo.h

/// Opens a photo as read_exif() does, and throws as it does.
std::unique_ptr<OIIO::ImageInput> open_noted(const std::filesystem::path& file);

/// What the camera noted in a photo that is open.
Exif exif_of(const OIIO::ImageInput& input, const std::filesystem::path& file);

/// The pixels of a photo that is open and no raw one, as read_photo() gives them. Throws as it does.
LinearPhoto linear_pixels_of(OIIO::ImageInput& input, const Photo& photo);

}  // namespace burin
