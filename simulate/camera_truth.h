// burin/simulate/camera_truth.h - effects of a simulated lens and phone: veiling glare, color filter array, white
// balance, an S-curve, sharpening. Independent of scene/response.h and capture/glare.h, which remove these effects.
//
// Fields of `sensor` in truth.json: mosaic; white_balance [r, g, b], white_balance_jitter; contrast, pivot;
// sharpen_amount, sharpen_px. The jitter is the standard deviation of the logarithm of R's and B's factor from photo to
// photo. Separate field: glare {share, core_px, reach_px}. The effects apply in the order of the light path.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "burin/base/image.h"
#include "burin/scene/sensor.h"

namespace burin {

class JsonObject;

/// Share of the light that the lens scatters as 1 / (r^2 + core^2) up to a reach; the rest stays.
struct GlareTruth {
  double share = 0, core_px = 4, reach_px = 500;
};

/// Effects on a picture between the lens and its file.
struct CameraTruth {
  GlareTruth glare;
  bool mosaic = false;  ///< RGGB; OpenCV's edge-aware demosaicing fills in the other colors
  Eigen::Vector3d white_balance{1, 1, 1};
  double white_balance_jitter = 0;
  double contrast = 1, pivot = 0.5;           ///< of the sRGB value, in logits
  double sharpen_amount = 0, sharpen_px = 1;  ///< unsharp mask of the stored brightness
};

/// Reads the fields above from `sensor`; missing fields keep their values. The caller calls finish().
void read_camera_truth(JsonObject& sensor, CameraTruth& camera);
GlareTruth read_glare_truth(JsonObject glare);

/// The light after scattering, all channels. Beyond the edge the picture continues at its value on the edge.
Image with_glare(const Image& radiance, const GlareTruth& glare);

/// Linear sensor values (0 to 1, noise included) to stored ones (0 to 1) before rounding. `seed` decides the photo's
/// own white balance.
Image developed(const Image& linear, Encoding encoding, const CameraTruth& camera, std::uint64_t seed);

}  // namespace burin
