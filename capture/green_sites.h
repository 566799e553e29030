// burin/capture/green_sites.h - color filter array: the green pixels of a photo. docs/model.md 9.24a.
//
// Half of such a sensor's pixels measure green, a quarter each red and blue; the camera interpolates the rest.
// Edge-directed demosaicing loses light of glints smaller than a pixel: it averages neighbors that agree, and these are
// dark. Photos with few bright glints lose most, up to two per cent, which biases roughness and depth. Brightness is
// reliable at measured green pixels (keep_green_sites(), burin/scene/response.h).
#pragma once

#include <span>

#include "burin/capture/session.h"
#include "burin/scene/response.h"

namespace burin {

/// Estimate of a sensor's color filter array.
struct GreenSitesFound {
  GreenSites sites = GreenSites::unknown;  ///< unknown: no array shows (another sensor, or a reduced photo)
  /// Logarithm of the ratio of fine detail (variance) at green sites to that elsewhere. Its standard error comes from
  /// the scatter over blocks of the photos.
  double detail = 0, detail_sigma = 0;
};

/// Examines up to four photos in color, except raw ones. Interpolated pixels hold less fine detail than measured ones.
/// Throws Error as read_photo() does.
GreenSitesFound find_green_sites(std::span<const Photo> photos);

}  // namespace burin
