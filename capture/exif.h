// burin/capture/exif.h - metadata of a photo file: how it was taken, without reading its pixels. All fields are
// optional: chats and editors remove EXIF.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "burin/capture/session.h"

namespace burin {

/// Metadata of a photo's header; a field is empty if the header lacks it.
struct Exif {
  int width = 0, height = 0, channels = 0, bits = 0;  ///< of the stored pixels; bits per channel
  std::string kind;                                   ///< file format: "jpeg", "png", "tiff", "openexr", "heif", "raw"
  std::optional<double> exposure_s, f_number, iso, focal_mm, focal_35mm;
  std::optional<double> sensor_width_mm;  ///< extent of the longer side, from the focal plane's resolution
  std::optional<double> time_s;           ///< capture time, seconds since 1970 on the camera's clock
  int orientation = 1;                    ///< EXIF's code; 1: as stored. Never applied to pixels
  std::string make, model;
  std::optional<bool> auto_white;  ///< the camera chose the white balance for this photo alone
  /// Encoding by the file's own metadata (burin/pictures/file_colors.h): sRGB, linear, or another curve, which
  /// read_photo() removes.
  bool says_srgb = false, says_linear = false, says_curve = false;
  /// EXIF calls the color space uncalibrated, and no profile identifies it.
  bool uncalibrated = false;
  bool gain_map = false;               ///< a second picture in the file brightens this one on HDR displays
  std::optional<bool> flash;           ///< the flash fired
  std::optional<double> digital_zoom;  ///< EXIF's ratio, from 1
};

/// Reads the header. Throws Error for a missing file and for other files than pictures.
Exif read_exif(const std::filesystem::path& file);

/// The f-number of all photos if none has one. A fixed aperture ring scales all photos alike, so this number only sets
/// the scale of their brightness.
inline constexpr double kAssumedAperture = 8;

/// The conversion of a file's values to linear ones. Raw files are "raw". A color profile decides between "linear" and
/// "srgb"; "srgb" also covers a custom curve, which read_photo() removes. Without a profile, JPEG and HEIC are "srgb",
/// and EXR and other floating-point files "linear". For a PNG or TIFF without metadata, 16 bits are linear
/// (machine-vision cameras, raw converters' linear output) and 8 bits sRGB.
struct AssumedEncoding {
  Encoding encoding = Encoding::linear;
  bool assumed = false;  ///< the file does not state its encoding
};
AssumedEncoding encoding_of(const Exif& exif);

/// Decide by the first bytes, not the name, if a file holds a photo, and if it is a camera's raw file. Thumbnails of
/// films (.thm) and unfinished files (.part, .tmp, ...) are no photos. A file without any picture but with a raw file's
/// name is a raw file: it has not arrived yet, or it is damaged.
bool is_photo(const std::filesystem::path& file);
bool is_raw(const std::filesystem::path& file);

/// True for names of files that cameras and programs write next to photos. Such files are skipped without a message.
bool is_sidecar_name(const std::filesystem::path& file);

/// True for a photo's name. A camera creates a file's name before it sends the content.
bool is_photo_name(const std::filesystem::path& file);

}  // namespace burin
