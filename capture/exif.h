// burin/capture/exif.h - what a photo's file says about how it was taken, without reading its pixels.
// Everything is optional: files lose their EXIF on the way through chats and editors.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "burin/capture/session.h"

namespace burin {

/// What a photo's header says; empty where it says nothing.
struct Exif {
  int width = 0, height = 0, channels = 0, bits = 0;  ///< of the pixels as stored; bits a channel
  std::string kind;                                   ///< the file's format: "jpeg", "png", "tiff", "openexr", "heif",
                                                      ///< "raw"
  std::optional<double> exposure_s, f_number, iso, focal_mm, focal_35mm;
  std::optional<double> sensor_width_mm;  ///< of the pixels' longer side, by the focal plane's resolution
  std::optional<double> time_s;           ///< when it was taken, seconds since 1970 on the camera's clock
  int orientation = 1;                    ///< EXIF's code; 1: as stored. Never applied to pixels
  std::string make, model;
  std::optional<bool> auto_white;  ///< whether the camera chose the white balance anew for this photo
  /// By its own words (burin/pictures/file_colors.h) the file's values lie along the sRGB curve, are in proportion
  /// to light, or lie along another curve, which read_photo() undoes.
  bool says_srgb = false, says_linear = false, says_curve = false;
  /// Its EXIF calls its color space uncalibrated, and no profile tells which it is.
  bool uncalibrated = false;
  bool gain_map = false;               ///< a second picture in the file brightens this one on HDR displays
  std::optional<bool> flash;           ///< whether the flash fired
  std::optional<double> digital_zoom;  ///< EXIF's ratio, from 1
};

/// Reads the header. Throws Error for a file that is missing or no picture.
Exif read_exif(const std::filesystem::path& file);

/// The f-number of photos of which none has one. An aperture ring that stays as it is scales all photos alike, so the
/// number itself changes nothing but the scale of their brightness.
inline constexpr double kAssumedAperture = 8;

/// How the file's values become linear: raw files "raw"; others "linear" or "srgb" by the color profile that they carry
/// ("srgb" also for a curve of its own, which read_photo() undoes). Without a profile, JPEG and HEIC are "srgb", and
/// EXR and other floating-point files "linear". For a PNG or TIFF that states nothing, 16 bits are taken as linear
/// (machine-vision and raw converters' linear output) and 8 bits as sRGB.
struct AssumedEncoding {
  Encoding encoding = Encoding::linear;
  bool assumed = false;  ///< nothing in the file says so
};
AssumedEncoding encoding_of(const Exif& exif);

/// Whether a file holds a photo, and whether it is a camera's raw file, by its first bytes and not by its name; but a
/// film's small picture (.thm) is no photo, nor is what a program has not finished (.part, .tmp, ...), and what holds
/// no picture of any kind is a raw file that has not come yet, or is damaged, if it has a raw file's name.
bool is_photo(const std::filesystem::path& file);
bool is_raw(const std::filesystem::path& file);

/// Whether a file that is no photo is one of those that cameras and programs put beside photos, by its name: such are
/// passed over without a word.
bool is_sidecar_name(const std::filesystem::path& file);

/// Whether a file that has not come yet (a camera names it before it sends it) has the name of a photo.
bool is_photo_name(const std::filesystem::path& file);

}  // namespace burin
