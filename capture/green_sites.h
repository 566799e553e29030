// burin/capture/green_sites.h - photos of a sensor that measures one color a pixel: which pixels measured green.
// docs/model.md 9.24a.
//
// Half of such a sensor's pixels measure green, a quarter each red and blue; the camera makes up the rest. Where glints
// are smaller than a pixel that loses light: a program that looks for edges takes the neighbors that agree with one
// another, and these are the dark ones. Photos with few bright glints lose most, up to two per cent, which looks like
// another roughness and another depth. Where green was measured, brightness is measured, too
// (keep_green_sites(), burin/scene/response.h).
#pragma once

#include <span>

#include "burin/capture/session.h"
#include "burin/scene/response.h"

namespace burin {

/// What photos tell of their sensor's mosaic.
struct GreenSitesFound {
  GreenSites sites = GreenSites::unknown;  ///< unknown: no mosaic shows (another sensor, or a photo made smaller)
  /// Logarithm of how much stronger fine detail (its variance) is where green was measured than elsewhere, and its
  /// standard error from the scatter over blocks of the photos.
  double detail = 0, detail_sigma = 0;
};

/// Looks at up to four of the photos that are in color and not raw. What is made up from neighbors holds less fine
/// detail than what was measured. Throws Error as read_photo() does.
GreenSitesFound find_green_sites(std::span<const Photo> photos);

}  // namespace burin
