// burin/scene/sensor.h - from radiance to a photo's values: blur (blur.h), exposure, vignetting, encoding, each
// written once and nowhere else. docs/model.md 5.7, 5.8.
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

/// Light that a lens scatters far over the picture: seen = (1 - share) x + share K x (burin/capture/glare.h).
/// Share 0: none. Lengths in the photo's own pixels.
struct Glare {
  double share = 0;
  double core_px = 4, reach_px = 500;
};

/// What a camera makes of radiance, before noise: docs/model.md 5.
struct Sensor {
  double gain = 1;
  Eigen::Vector3d vignette{0, 0, 0};  ///< v1 v2 v3 of vignette_at()
  std::optional<Eigen::Vector3d> vignette_sigma;
  double psf_sigma_px = 0;                   ///< Gaussian blur on the pixel grid, on top of the pixel's own square
  std::optional<double> psf_sigma_sigma_px;  ///< one standard deviation of psf_sigma_px
  Glare glare;                               ///< far over the picture
  std::optional<double> glare_share_sigma;
  // How its files are read; nothing of it is predicted.
  Response response;
  Sharpening sharpening;
  GreenSites green_sites = GreenSites::unknown;
  /// By a photo's file, relative to its session: factors on R, G and B that this photo was stored with beside those of
  /// all photos (white balance chosen anew, a shutter that errs). Not named: 1.
  std::map<std::string, Eigen::Vector3d> balance;
};

/// How a file keeps linear values.
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

/// A linear value from 0 to 1 as it is encoded (raw values are linear).
float encoded(float linear_value, Encoding encoding);

}  // namespace burin
