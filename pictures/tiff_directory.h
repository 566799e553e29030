// burin/pictures/tiff_directory.h - parser of a TIFF's directories, also of camera raw files with this layout, and a
// test of the completeness of its pixel data.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "burin/pictures/picture_bytes.h"

namespace burin {

/// The used entries of one directory (TIFF 6.0, section 2).
struct TiffDirectory {
  std::int64_t width = 0, height = 0, samples = 1, bits = 1;
  std::int64_t compression = 1, photometric = -1, planes = 1, fill_order = 1;
  std::int64_t rows_per_strip = 0xFFFFFFFF, tile_width = 0, tile_height = 0;
  std::vector<std::uint64_t> place, bytes;  ///< of its strips or tiles
  std::string maker;                        ///< Make and UniqueCameraModel, concatenated
  bool dng = false;                         ///< has a DNGVersion
  std::uint64_t exif = 0;                   ///< offset of its EXIF; 0: none
  std::int64_t iso = 0;                     ///< of EXIF (PhotographicSensitivity); 0: absent

  /// Values of a color mosaic, or of a demosaiced sensor (PhotometricInterpretation of TIFF/EP and DNG).
  bool sensor_values() const { return photometric == 32803 || photometric == 34892; }
};

/// All directories, with sub-directories and EXIF, in order of discovery; the first is the main one. Throws Error
/// for a directory, a tile or a strip beyond its possible size.
std::vector<TiffDirectory> read_tiff_directories(PictureBytes& file);

/// Throws Error if strips or tiles are missing or extend beyond the file's end.
void require_parts_within(PictureBytes& file, const TiffDirectory& directory);

/// Throws Error if a strip or tile of LZW, PackBits or Deflate does not unpack to its expected size, which reveals most
/// damage. Checks lengths alone, and for Deflate also the checksum. Other compressions pass.
void require_parts_unpack(PictureBytes& file, const TiffDirectory& directory);

}  // namespace burin
