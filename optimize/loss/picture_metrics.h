// burin/optimize/loss/picture_metrics.h - quality of a shown picture: PSNR, SSIM, correlation, best exposure.
//
// Pictures have one channel, are gamma-encoded with white at 1, and have equal sizes (Error otherwise). An empty mask
// means every pixel.
#pragma once

#include "burin/base/image.h"

namespace burin {

/// Peak signal-to-noise ratio in dB, -10 log10(mean squared difference); 99 for equal pictures.
double psnr_db(const Image& picture, const Image& target, const Image& mask = {});

/// Mean structural similarity (Wang, Bovik, Sheikh & Simoncelli, IEEE TIP 13(4), 2004). The Gaussian window has sigma
/// 1.5 on 11 x 11 pixels; K1 = 0.01, K2 = 0.03, L = 1. Windows beyond the picture's edge are omitted. Pixels with mask
/// 0 are absent: the other pixels give a window's statistics, and the mask at its middle is its weight.
double ssim(const Image& picture, const Image& target, const Image& mask = {});

/// Pearson correlation of two pictures' values, -1 to 1; 0 if one of them has one tone.
double correlation(const Image& a, const Image& b, const Image& mask = {});

/// The exposure near `guess` whose shown picture, exposure * radiance with gamma 1/2.2 and clipped, is closest to the
/// target in mean square.
double best_exposure(const Image& radiance, const Image& target, double guess, const Image& mask = {});

}  // namespace burin
