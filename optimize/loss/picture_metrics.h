// burin/optimize/loss/picture_metrics.h - how good a shown picture is, in the figures that people compare.
// Pictures: one channel, gamma-encoded, white is 1, equal sizes (Error otherwise). An empty mask means every pixel.
#pragma once

#include "burin/base/image.h"

namespace burin {

/// Peak signal-to-noise ratio in dB, -10 log10(mean squared difference); 99 where there is no difference.
double psnr_db(const Image& picture, const Image& target, const Image& mask = {});

/// Mean structural similarity (Wang, Bovik, Sheikh & Simoncelli, IEEE TIP 13(4), 2004): Gaussian window of sigma 1.5
/// on 11 x 11 pixels, K1 = 0.01, K2 = 0.03, L = 1; windows that leave the picture are left out. Where the mask is 0
/// there are no pixels: windows take their statistics from the others, and count by the mask at their middle.
double ssim(const Image& picture, const Image& target, const Image& mask = {});

/// Pearson correlation of two pictures' values, -1 to 1; 0 where one of them is of one tone.
double correlation(const Image& a, const Image& b, const Image& mask = {});

/// The one exposure, near `guess`, with which exposure * radiance, shown (gamma 1/2.2, clipped), comes closest to the
/// target in mean square.
double best_exposure(const Image& radiance, const Image& target, double guess, const Image& mask = {});

}  // namespace burin
