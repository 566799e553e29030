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

#include "burin/render/limits.h"

namespace burin {

/// What a picture's own header says.
struct PictureHeader {
  std::string kind;  ///< OpenImageIO's name of its reader: "png", "jpeg", "tiff", "openexr", "raw", ...
  std::int64_t width = 0, height = 0;  ///< the largest that it names; 0 where only its library can tell (some raws)
  std::string exif;      ///< EXIF that its reader passes over (PNG's, WebP's), from its TIFF header on; else empty
  std::int64_t iso = 0;  ///< of a TIFF's EXIF, which its reader passes over; 0: not said
  bool moves = false;    ///< a sequence of pictures, of which the first one is read
};

/// The kind of a file by its first bytes; empty for one that is missing or none of ours. Never throws. Names count for
/// one thing alone: what begins as a TIFF does and has no mark of a raw file is one under a name that cameras give to
/// raw files.
std::string picture_kind(const std::filesystem::path& file);

/// Whether cameras give such names to raw files (".dng").
bool has_raw_name(const std::filesystem::path& file);

/// Reads the header. Kinds: PNG, JPEG, TIFF, EXR, Radiance HDR, HEIF (HEIC, AVIF), WebP, BMP, GIF, PNM, and cameras'
/// raw files, by their first bytes. Throws Error for anything else, and for a header that is broken or whose parts
/// cannot fit into the file; for a DNG that is compressed by JPEG XL; and for a Hasselblad's raw file, by which
/// LibRaw's memory is harmed.
PictureHeader read_picture_header(const std::filesystem::path& file);

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

/// Throws Error unless width x height is a picture of at most `most` pixels, its sides within `most_side`.
void require_picture_size(std::int64_t width, std::int64_t height, std::int64_t most, const std::string& where,
                          const std::string& kind, std::int64_t most_side = limit::kPictureSide);

}  // namespace burin
