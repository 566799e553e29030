// burin/pictures/encoded_picture.h - a picture file's bytes, made in memory. So a full disk truncates no picture, and a
// library's method of writing files does not matter. Include it in .cpp files only: it includes OpenImageIO.
#pragma once

#include <OpenImageIO/imageio.h>

#include <filesystem>
#include <string>

namespace burin {

/// Bytes of a picture in the format of `extension` (".png"), from pixels of `type`. The same pixels give the same
/// bytes: the file has no date unless `spec` has one. Throws Error with the name of `file`, the intended output.
std::string encoded_picture(const std::string& extension, OIIO::ImageSpec spec, const OIIO::TypeDesc& type,
                            const void* pixels, const std::filesystem::path& file);

}  // namespace burin
