// burin/capture/glare.h - veiling glare: light scattered by a lens far over the picture. docs/model.md 5.13.
//
//   seen = (1 - share) x + share K x,      K ~ 1 / (r^2 + core_px^2) for r up to reach_px, its sum 1.
//
// K is broad, so a picture of a few hundred pixels across suffices for K x. The share is small, so K of the photo
// itself approximates K x. A pixel is therefore predicted without its whole photo. Beyond the picture's edge the light
// continues at its value on the edge.
#pragma once

#include "burin/base/image.h"
#include "burin/scene/sensor.h"

namespace burin {

/// K of a one-channel image at the image's own pixels; each is `pixel_px` photo pixels wide. The error is below 1 % of
/// K x if the image holds no point lights.
Image glare_of(const Image& seen, const Glare& glare, double pixel_px = 1);

/// A one-channel picture averaged over cells of 4 x 4 pixels. glare_of() needs no more of distant pixels.
Image coarse_for_glare(const Image& seen);

/// Glare in a part of a picture. (x0, y0) is the part's top-left pixel in the whole picture, and `coarse` is
/// coarse_for_glare() of the whole. Equals glare_of() of the whole except within 12 pixels of the part's edge.
Image glare_of(const Image& part, int x0, int y0, const Image& coarse, const Glare& glare, double pixel_px);

}  // namespace burin
