// burin/pictures/file_colors.h - the colors that a file states for its values: an ICC profile, a PNG's or HEIF's
// code points (ITU-T H.273), a gamma, EXIF's color space. They are undone here, so that all other code knows sRGB and
// linear values only. Include it in .cpp files only: it pulls in OpenImageIO.
//
// Precedence: code points before an ICC profile before a gamma in PNG (PNG 3, 4.3), an ICC profile before code points
// in HEIF (ISO 23000-22, 7.3.6.4), and either before EXIF.
#pragma once

#include <OpenImageIO/imageio.h>

#include <array>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace burin {

/// What a file states about the colors of its values.
struct FileColors {
  enum class Curve { unstated, srgb, linear, other };
  Curve curve = Curve::unstated;
  std::string name;      ///< "the color profile \"Adobe RGB (1998)\""; empty if nothing is stated
  bool is_srgb = false;  ///< curve and primaries: nothing needs to be undone in a picture
  /// EXIF says "uncalibrated" (its color space 65535), and nothing else in the file says what that is.
  bool uncalibrated = false;
  std::shared_ptr<void> profile;  ///< lcms2's handle; empty unless the curve or the primaries are others than sRGB's
};

/// Reads the statement of an opened file. Throws Error, naming the remedy, for a profile that cannot be read and for
/// values along the curves of HDR displays (PQ, HLG).
FileColors file_colors(const OIIO::ImageInput& input, const std::filesystem::path& file);

/// Whether the file carries a gain map (Ultra HDR, ISO 21496-1, Apple's): a second picture that brightens the first on
/// HDR displays. The first is what is read.
bool has_gain_map(const OIIO::ImageInput& input, const std::filesystem::path& file);

/// One channel's curve from stored values in [0, 1] to what sRGB would have stored for the same light, sampled at
/// i / (size - 1). Only the curve is undone: photos measure light in the camera's own primaries.
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
  ToSrgbCurve gray_;                 ///< for each channel; empty: none
  std::shared_ptr<void> transform_;  ///< of three channels; empty: none
};

}  // namespace burin
