// burin/pictures/encoded_picture.h - a picture file's bytes, made in memory: a full disk then cuts no picture, and
// no library's way of writing files has to be trusted. Include it in .cpp files only: it pulls in OpenImageIO.
#pragma once

#include <OpenImageIO/imageio.h>

#include <filesystem>
#include <string>

namespace burin {

/// The bytes of a picture of the kind that `extension` (".png") names, from pixels of `type`. The same pixels give the
/// same bytes: no date is in it unless `spec` has one. Throws Error naming `file`, which it is for.
std::string encoded_picture(const std::string& extension, OIIO::ImageSpec spec, const OIIO::TypeDesc& type,
                            const void* pixels, const std::filesystem::path& file);

}  // namespace burin
