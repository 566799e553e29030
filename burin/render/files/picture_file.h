// burin/render/files/picture_file.h - pictures and photos opened: what kind they are is decided by their first bytes,
// and how large they are is read from their headers, before a library takes memory for them. Include it in .cpp files
// only: it pulls in OpenImageIO.
#pragma once

#include <OpenImageIO/imageio.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace burin {

/// What a picture's own header says.
struct PictureHeader {
  std::string kind;  ///< OpenImageIO's name of its reader: "png", "jpeg", "tiff", "openexr", "raw", ...
  std::int64_t width = 0, height = 0;  ///< the largest that it names; 0 where only its library can tell (some raws)
};

/// Reads the header. Kinds: PNG, JPEG, TIFF, EXR, Radiance HDR, HEIF (HEIC, AVIF), WebP, BMP, GIF, PNM, and with
/// `raw_name` (a name that cameras give to raw files) raw. Throws Error for anything else, and for a header that is
/// broken or whose parts cannot fit into the file; and for a Hasselblad's raw file, by which LibRaw's memory is harmed.
PictureHeader read_picture_header(const std::filesystem::path& file, bool raw_name);

struct PictureLimits {
  std::int64_t pixels;
  std::string kind;       ///< what sentences call it: "a photo"
  std::string remedy;     ///< for a file that is no picture
  bool raw_name = false;  ///< its name says that it is a camera's raw file
};

/// A picture, opened by the reader of its kind, after its header was found to be within `limits`, and what the library
/// then says of it too: sides, pixels, channels, tiles, no volume. Throws Error.
std::unique_ptr<OIIO::ImageInput> open_picture(const std::filesystem::path& file, const PictureLimits& limits,
                                               const OIIO::ImageSpec& config = {});

/// Throws Error unless width x height is a picture of at most `most` pixels.
void require_picture_size(std::int64_t width, std::int64_t height, std::int64_t most, const std::string& where,
                          const std::string& kind);

}  // namespace burin
