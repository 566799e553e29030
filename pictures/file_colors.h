// burin/pictures/file_colors.h - color encoding of a file's values: an ICC profile, the code points of a PNG or HEIF
// (ITU-T H.273), a gamma, EXIF's color space. This module converts to sRGB, so all other code uses sRGB and linear
// values only. Include it in .cpp files only: it includes OpenImageIO.
//
// Precedence in PNG: code points before an ICC profile before a gamma (PNG 3, 4.3). In HEIF: an ICC profile before code
// points (ISO 23000-22, 7.3.6.4). Both precede EXIF.
#pragma once

#include <OpenImageIO/imageio.h>

#include <array>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace burin {

/// A file's declaration of the colors of its values.
struct FileColors {
  enum class Curve { unstated, srgb, linear, other };
  Curve curve = Curve::unstated;
  std::string name;      ///< "the color profile \"Adobe RGB (1998)\""; empty without a declaration
  bool is_srgb = false;  ///< curve and primaries: a picture needs no conversion
  /// EXIF has "uncalibrated" (color space 65535), and nothing else in the file defines the colors.
  bool uncalibrated = false;
  std::shared_ptr<void> profile;  ///< lcms2's handle; empty unless the curve or the primaries differ from sRGB's
};

/// Reads the declaration of an open file. Throws Error with a remedy for an unreadable profile and for values along the
/// curves of HDR displays (PQ, HLG).
FileColors file_colors(const OIIO::ImageInput& input, const std::filesystem::path& file);

/// True if the file has a gain map (Ultra HDR, ISO 21496-1, Apple's): a second picture that brightens the first on HDR
/// displays. Readers use the first.
bool has_gain_map(const OIIO::ImageInput& input, const std::filesystem::path& file);

/// One channel's curve from stored values in [0, 1] to sRGB's stored values for the same light, sampled at i / (size -
/// 1). It converts the curve alone, because photos measure light in the camera's own primaries.
using ToSrgbCurve = std::vector<float>;

/// One curve per channel; empty if the file's curve is sRGB's, linear or unstated. `channels` is 1 or 3.
std::vector<ToSrgbCurve> to_srgb_curves(const FileColors& colors, int channels);

/// The curve at a stored value.
float curve_at(const ToSrgbCurve& curve, float stored);

/// Converts whole pixels, curve and primaries, to sRGB's stored values (for pictures on screens).
class ToSrgbColors {
 public:
  ToSrgbColors() = default;
  ToSrgbColors(const FileColors& colors, int channels);

  /// Converts the first channels of `count` pixels, `stride` values apart, not multiplied by alpha.
  void convert(float* pixels, std::size_t count, int stride) const;

 private:
  int channels_ = 1;
  ToSrgbCurve gray_;                 ///< for each channel; empty: no conversion
  std::shared_ptr<void> transform_;  ///< of three channels; empty: no conversion
};

}  // namespace burin
