// burin/pictures/picture_file.h - opens pictures and photos. First bytes determine the kind, and headers give the size
// before a library allocates memory. Include it in .cpp files only: it includes OpenImageIO.
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
  std::string kind;    ///< name in messages: "a photo"
  std::string remedy;  ///< for a file that is no picture
  bool photo = false;  ///< also reads raw files, HEIF as the sensor stored it; limits the sides to a tag detector's
};

/// Opens a picture with the reader of its kind, after its header was found within `limits`. The library's own values
/// are checked too: sides, pixels, channels, tiles, no volume. Throws Error.
std::unique_ptr<OIIO::ImageInput> open_picture(const std::filesystem::path& file, const PictureLimits& limits,
                                               const OIIO::ImageSpec& config = {});

/// Attributes of an opened picture, with the EXIF that its reader ignores.
OIIO::ImageSpec described(const OIIO::ImageInput& input, const std::filesystem::path& file);

/// Call it before reading pixels: throws Error if the file's coding has damage that its reader ignores.
void require_whole(const OIIO::ImageInput& input, const std::filesystem::path& file);

/// Call it after reading pixels: throws Error unless `read`, and if the reader reported an error in spite of it.
void require_read(bool read, const OIIO::ImageInput& input, const std::filesystem::path& file,
                  const std::string& remedy);

}  // namespace burin
