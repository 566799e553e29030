#include "burin/capture/exif.h"

#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <string_view>

#include "burin/base/error.h"
#include "burin/base/files/file_names.h"
#include "burin/base/files/input_file.h"
#include "burin/base/files/printable.h"
#include "burin/base/files/table.h"
#include "burin/base/limits.h"
#include "burin/pictures/file_colors.h"
#include "burin/pictures/picture_file.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

// EXIF's fractions arrive as floats, and some were written with few digits: 1/60 s becomes 1/60 again, and 5.6 not
// 5.599999905.
double tidied(float value) {
  const double inverse = std::round(1.0 / value);
  if (inverse >= 2 && inverse <= 8000 && std::abs(value * inverse - 1) < 5e-5) return 1 / inverse;
  const double unit = std::pow(10, std::floor(std::log10(value)) - 6);
  std::array<char, 32> text;
  const auto written = std::to_chars(text.data(), text.data() + text.size(), std::round(value / unit) * unit,
                                     std::chars_format::general, 7);
  return number_in({text.data(), written.ptr}).value_or(value);
}

// OpenImageIO 2.4 gives whole numbers as floats if they have 16 bits (a JPEG's), and not if they have 32 (a TIFF's).
std::optional<double> positive(const OIIO::ImageSpec& spec, std::initializer_list<const char*> names) {
  for (const char* name : names) {
    const float value = spec.get_float_attribute(name, static_cast<float>(spec.get_int_attribute(name, -1)));
    if (value > 0 && std::isfinite(value)) return tidied(value);
  }
  return std::nullopt;
}

// FocalPlaneXResolution counts pixels per unit of the sensor (2: inch, 3: cm, 4: mm, 5: um; EXIF 2.3, 4.6.5). Its
// pixels are those of PixelXDimension, not those of a reduced photo.
std::optional<double> sensor_width_mm(const OIIO::ImageSpec& spec) {
  const double resolution = spec.get_float_attribute("Exif:FocalPlaneXResolution", -1);
  const int unit = spec.get_int_attribute("Exif:FocalPlaneResolutionUnit", 2);
  constexpr std::array<double, 6> kUnit_mm{0, 0, 25.4, 10, 1, 1e-3};
  if (!(resolution > 0) || unit < 2 || unit > 5) return std::nullopt;
  const int counted = std::max(spec.get_int_attribute("Exif:PixelXDimension", spec.width),
                               spec.get_int_attribute("Exif:PixelYDimension", spec.height));
  const double width = counted / resolution * kUnit_mm[static_cast<std::size_t>(unit)];
  constexpr double kSmallest_mm = 1, kLargest_mm = 100;  // other values are a scanner's, or nonsense
  if (!(width >= kSmallest_mm && width <= kLargest_mm)) return std::nullopt;
  return width;
}

// "2024:05:18 20:42:22", or with dashes as LibRaw's plugin writes it; with hundredths of a second if present.
std::optional<double> time_of(const OIIO::ImageSpec& spec) {
  for (const char* name : {"Exif:DateTimeOriginal", "Exif:DateTimeDigitized", "DateTime"}) {
    const std::string text = spec.get_string_attribute(name);
    std::tm t{};
    if (std::sscanf(text.c_str(), "%d%*c%d%*c%d %d:%d:%d", &t.tm_year, &t.tm_mon, &t.tm_mday, &t.tm_hour, &t.tm_min,
                    &t.tm_sec) != 6 ||
        t.tm_year < 1971 || t.tm_year > 9999)
      continue;
    t.tm_year -= 1900;
    t.tm_mon -= 1;
    const std::string part = spec.get_string_attribute("Exif:SubsecTimeOriginal");
    double fraction = 0;
    if (!part.empty() && part.find_first_not_of("0123456789") == std::string::npos && part.size() < 10)
      fraction = number_in("0." + part).value_or(0);
    return static_cast<double>(timegm(&t)) + fraction;
  }
  return std::nullopt;
}

constexpr std::array<std::string_view, 20> kPictures{".jpg", ".jpeg", ".jpe",  ".jfif", ".png",  ".tif",  ".tiff",
                                                     ".exr", ".heic", ".heif", ".hif",  ".avif", ".webp", ".bmp",
                                                     ".gif", ".hdr",  ".pnm",  ".ppm",  ".pgm",  ".pbm"};
constexpr std::array<std::string_view, 16> kSidecars{".xmp", ".aae", ".thm", ".mov", ".mp4", ".m4v", ".avi", ".lrv",
                                                     ".3gp", ".mts", ".wav", ".txt", ".ini", ".db",  ".pp3", ".dop"};

// Extensions of files that never count as photos: thumbnails of films, and unfinished copies of programs.
constexpr std::array<std::string_view, 8> kNoPhotos{".thm",      ".part",       ".tmp",      ".partial",
                                                    ".download", ".crdownload", ".filepart", ".icloud"};

template <std::size_t kCount>
bool has_extension_of(const std::array<std::string_view, kCount>& extensions, const fs::path& file) {
  return std::find(extensions.begin(), extensions.end(), lower_extension(file)) != extensions.end();
}

}  // namespace

Exif read_exif(const fs::path& file) {
  const std::unique_ptr<OIIO::ImageInput> input = open_picture(
      file, {limit::kPhotoPixels, "a photo", "copy it from the camera again, or take it out of the folder", true});
  const OIIO::ImageSpec spec = described(*input, file);
  Exif exif;
  exif.width = spec.width;
  exif.height = spec.height;
  exif.channels = spec.nchannels;
  exif.bits = static_cast<int>(spec.format.size() * 8);
  exif.kind = input->format_name();
  exif.exposure_s = positive(spec, {"ExposureTime"});
  if (!exif.exposure_s && spec.find_attribute("Exif:ShutterSpeedValue"))
    exif.exposure_s = std::exp2(-spec.get_float_attribute("Exif:ShutterSpeedValue"));
  exif.f_number = positive(spec, {"FNumber"});
  if (!exif.f_number && spec.get_float_attribute("Exif:ApertureValue") > 0)
    exif.f_number = std::exp2(spec.get_float_attribute("Exif:ApertureValue") / 2);
  exif.iso = positive(spec, {"Exif:PhotographicSensitivity", "Exif:ISOSpeedRatings", "Exif:ISOSpeed"});
  exif.focal_mm = positive(spec, {"Exif:FocalLength"});
  exif.focal_35mm = positive(spec, {"Exif:FocalLengthIn35mmFilm"});
  exif.sensor_width_mm = sensor_width_mm(spec);
  exif.time_s = time_of(spec);
  // The raw plugin rotates pixels by default, and then reports 1; it keeps the camera's value in an attribute of its
  // own.
  exif.orientation = spec.get_int_attribute("raw:Orientation", spec.get_int_attribute("Orientation", 1));
  exif.make = printable(spec.get_string_attribute("Make"));
  exif.model = printable(spec.get_string_attribute("Model"));
  const int white = spec.get_int_attribute("Exif:WhiteBalance", -1);  // EXIF 2.32: 0 automatic, 1 manual
  if (white == 0 || white == 1) exif.auto_white = white == 0;
  const FileColors colors = file_colors(*input, file);
  exif.says_srgb = colors.curve == FileColors::Curve::srgb;
  exif.says_linear = colors.curve == FileColors::Curve::linear;
  exif.says_curve = colors.curve == FileColors::Curve::other;
  exif.uncalibrated = colors.uncalibrated;
  exif.gain_map = has_gain_map(*input, file);
  // EXIF 2.32, 4.6.5: bit 0 of Flash; DigitalZoomRatio is 0 without digital zoom.
  if (const int flash = spec.get_int_attribute("Exif:Flash", -1); flash >= 0) exif.flash = (flash & 1) != 0;
  exif.digital_zoom = positive(spec, {"Exif:DigitalZoomRatio"});
  return exif;
}

AssumedEncoding encoding_of(const Exif& exif) {
  if (exif.kind == "raw") return {Encoding::raw, false};
  if (exif.says_linear) return {Encoding::linear, false};
  if (exif.says_srgb || exif.says_curve || exif.kind == "jpeg" || exif.kind == "heif") return {Encoding::srgb, false};
  if (exif.kind == "openexr" || exif.bits > 16) return {Encoding::linear, false};
  return {exif.bits == 16 ? Encoding::linear : Encoding::srgb, true};
}

bool is_sidecar_name(const fs::path& file) { return has_extension_of(kSidecars, file); }

bool is_photo_name(const fs::path& file) { return has_raw_name(file) || has_extension_of(kPictures, file); }

bool is_raw(const fs::path& file) {
  const std::string kind = picture_kind(file);
  return kind == "raw" || (kind.empty() && has_raw_name(file));
}

bool is_photo(const fs::path& file) { return !has_extension_of(kNoPhotos, file) && !picture_kind(file).empty(); }

}  // namespace burin
