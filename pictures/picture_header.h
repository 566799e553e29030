// burin/pictures/picture_header.h - a picture's kind and size from its first bytes, before a library opens it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace burin {

/// What a picture's own header says.
struct PictureHeader {
  std::string kind;  ///< OpenImageIO's name of its reader: "png", "jpeg", "tiff", "openexr", "raw", ...
  std::int64_t width = 0, height = 0;  ///< the largest that it names; 0 where only its library can tell (some raws)
  std::string exif;       ///< EXIF that its reader passes over (PNG's, WebP's), from its TIFF header on; else empty
  std::int64_t iso = 0;   ///< of a TIFF's EXIF, which its reader passes over; 0: not said
  bool moves = false;     ///< a sequence of pictures, of which the first one is read
  bool has_runs = false;  ///< a BMP that is compressed by runs, of which OpenImageIO 2.4 reads some only
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

}  // namespace burin
