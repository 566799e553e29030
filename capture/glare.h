// burin/capture/glare.h - light that a lens scatters far over the picture. docs/model.md 5.13.
//
//   seen = (1 - share) x + share K x,      K ~ 1 / (r^2 + core_px^2) for r up to reach_px, its sum 1.
//
// K is broad, so K x is as good from a picture of a few hundred pixels across; and share is small, so K of the photo
// itself will do for K x: a pixel is predicted without its whole photo. Beyond the picture's edge the light goes on as
// it ends.
#pragma once

#include "burin/base/image.h"
#include "burin/scene/sensor.h"

namespace burin {

/// K of an image of one channel whose pixels are `pixel_px` of the photo's wide, at the image's own pixels. Errs by
/// less than 1 % of K x where the image holds no point lights.
Image glare_of(const Image& seen, const Glare& glare, double pixel_px = 1);

/// A picture of one channel in cells of 4 x 4 pixels, averaged: all that glare_of() needs of distant pixels.
Image coarse_for_glare(const Image& seen);

/// Glare in a part of a picture. (x0, y0) is the part's top-left pixel in the whole picture, and `coarse` is
/// coarse_for_glare() of the whole. Equals glare_of() of the whole except within 12 pixels of the part's edge.
Image glare_of(const Image& part, int x0, int y0, const Image& coarse, const Glare& glare, double pixel_px);

}  // namespace burin
