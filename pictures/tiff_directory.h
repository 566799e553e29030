// burin/pictures/tiff_directory.h - the directories of a TIFF, of camera raw files built like it too, read by hand;
// and whether the bytes of its pixels are all there.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "burin/pictures/picture_bytes.h"

namespace burin {

/// One directory (TIFF 6.0, section 2): what is used of it.
struct TiffDirectory {
  std::int64_t width = 0, height = 0, samples = 1, bits = 1;
  std::int64_t compression = 1, photometric = -1, planes = 1, fill_order = 1;
  std::int64_t rows_per_strip = 0xFFFFFFFF, tile_width = 0, tile_height = 0;
  std::vector<std::uint64_t> place, bytes;  ///< of its strips or tiles
  std::string maker;                        ///< Make and UniqueCameraModel, one after the other
  bool dng = false;                         ///< it has a DNGVersion
  std::uint64_t exif = 0;                   ///< where its EXIF stands; 0: nowhere
  std::int64_t iso = 0;                     ///< of EXIF (PhotographicSensitivity); 0: not said

  /// Values of a color mosaic, or of a sensor filled in (PhotometricInterpretation of TIFF/EP and DNG).
  bool sensor_values() const { return photometric == 32803 || photometric == 34892; }
};

/// All directories, sub-directories and EXIF too, in the order in which they are found; the first is the main one.
/// Throws Error for a directory, a tile or a strip that is larger than it can be.
std::vector<TiffDirectory> read_tiff_directories(PictureBytes& file);

/// Throws Error where strips or tiles are missing or lie beyond the file's end.
void require_parts_within(PictureBytes& file, const TiffDirectory& directory);

/// Throws Error where a strip or tile of LZW, PackBits or Deflate does not unpack to as many bytes as it has to: that
/// is how most damage shows. Lengths alone are followed, but for Deflate, which has a checksum. Other compressions
/// pass.
void require_parts_unpack(PictureBytes& file, const TiffDirectory& directory);

}  // namespace burin
