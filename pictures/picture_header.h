// burin/pictures/picture_header.h - a picture's kind and size from its first bytes, before a library opens it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace burin {

/// Contents of a picture's own header.
struct PictureHeader {
  std::string kind;  ///< OpenImageIO's name of its reader: "png", "jpeg", "tiff", "openexr", "raw", ...
  std::int64_t width = 0, height = 0;  ///< largest declared size; 0 if only the library can determine it (some raws)
  std::string exif;       ///< EXIF that the reader ignores (PNG's, WebP's), from its TIFF header on; else empty
  std::int64_t iso = 0;   ///< of a TIFF's EXIF, which its reader ignores; 0: absent
  bool moves = false;     ///< a sequence of pictures; the reader uses the first
  bool has_runs = false;  ///< a BMP with run-length compression, which OpenImageIO 2.4 reads only in part
};

/// Kind of a file by its first bytes; empty for a missing file or an unsupported one. Never throws. Names matter in one
/// case only. A file that begins as a TIFF without a mark of a raw file is raw if has_raw_name().
std::string picture_kind(const std::filesystem::path& file);

/// True if cameras give such names to raw files (".dng").
bool has_raw_name(const std::filesystem::path& file);

/// Reads the header. Kinds, by their first bytes: PNG, JPEG, TIFF, EXR, Radiance HDR, HEIF (HEIC, AVIF), WebP, BMP,
/// GIF, PNM, and cameras' raw files. Throws Error for:
/// - any other file;
/// - a broken header, or one with parts that cannot fit into the file;
/// - a DNG with JPEG XL compression;
/// - a Hasselblad's raw file, which corrupts LibRaw's memory.
PictureHeader read_picture_header(const std::filesystem::path& file);

}  // namespace burin
