// burin/scene/sensor.h - from radiance to a photo's values: blur (blur.h), exposure, vignetting and encoding. The whole
// program shares this one implementation. docs/model.md 5.7, 5.8.
//
//   value = gain * exposure_factor * vignette(r) * blur(radiance),      1 being the white level.
//
// Pixels: the center of the top-left pixel is (0, 0).
#pragma once

#include <Eigen/Core>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "burin/base/image.h"
#include "burin/scene/blur.h"
#include "burin/scene/response.h"

namespace burin {

/// Veiling glare: seen = (1 - share) x + share K x (burin/capture/glare.h). Share 0: none. Lengths are in the photo's
/// own pixels.
struct Glare {
  double share = 0;
  double core_px = 4, reach_px = 500;
};

/// The camera's map from radiance to values, before noise: docs/model.md 5.
struct Sensor {
  double gain = 1;
  Eigen::Vector3d vignette{0, 0, 0};  ///< v1 v2 v3 of vignette_at()
  std::optional<Eigen::Vector3d> vignette_sigma;
  double psf_sigma_px = 0;                   ///< Gaussian blur on the pixel grid, on top of the pixel's own square
  std::optional<double> psf_sigma_sigma_px;  ///< one standard deviation of psf_sigma_px
  Glare glare;                               ///< veiling glare
  std::optional<double> glare_share_sigma;
  // Reading of the camera's files; predictions do not use it.
  Response response;
  Sharpening sharpening;
  GreenSites green_sites = GreenSites::unknown;
  /// Factors on R, G and B per photo, in addition to those of all photos: a new white balance, an inaccurate shutter.
  /// The key is a photo's file relative to its session. Missing keys mean 1.
  std::map<std::string, Eigen::Vector3d> balance;
};

/// Encoding of linear values in a file.
enum class Encoding { linear, srgb, raw };

/// exposure_s * (iso / 100) / f_number^2: a photo's linear value is gain * this * vignette * radiance.
inline double exposure_factor(double exposure_s, double iso, double f_number) {
  return exposure_s * (iso / 100) / (f_number * f_number);
}

/// 1 + v1 r^2 + v2 r^4 + v3 r^6. Templated: double, Ceres Jets.
template <typename T>
T vignette_at(const T* vignette, double radius2) {
  return 1. + radius2 * (vignette[0] + radius2 * (vignette[1] + radius2 * vignette[2]));
}

/// r^2 of a pixel: squared distance from the image's center ((W - 1) / 2, (H - 1) / 2) over half its diagonal.
double vignette_radius2(int width, int height, double x_px, double y_px);

/// A linear value from 0 to 1 in that encoding (raw values are linear).
float encoded(float linear_value, Encoding encoding);

}  // namespace burin
