// burin/pictures/picture_file.h - pictures and photos opened: what kind they are is decided by their first bytes,
// and how large they are is read from their headers, before a library takes memory for them. Include it in .cpp files
// only: it pulls in OpenImageIO.
#pragma once

#include <OpenImageIO/imageio.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "burin/base/limits.h"
#include "burin/pictures/picture_header.h"

namespace burin {

struct PictureLimits {
  std::int64_t pixels;
  std::string kind;    ///< what sentences call it: "a photo"
  std::string remedy;  ///< for a file that is no picture
  bool photo = false;  ///< raw files are read too, HEIF as the sensor had it, and sides are those of a tag detector
};

/// A picture, opened by the reader of its kind, after its header was found to be within `limits`, and what the library
/// then says of it too: sides, pixels, channels, tiles, no volume. Throws Error.
std::unique_ptr<OIIO::ImageInput> open_picture(const std::filesystem::path& file, const PictureLimits& limits,
                                               const OIIO::ImageSpec& config = {});

/// What an opened picture's file says of it, with the EXIF that its reader passes over.
OIIO::ImageSpec described(const OIIO::ImageInput& input, const std::filesystem::path& file);

/// To be called before pixels are read: throws Error where the file's coding shows damage that its reader passes over.
void require_whole(const OIIO::ImageInput& input, const std::filesystem::path& file);

/// To be called after pixels were read: throws Error unless `read`, and where the reader has said an error all the
/// same.
void require_read(bool read, const OIIO::ImageInput& input, const std::filesystem::path& file,
                  const std::string& remedy);

}  // namespace burin
