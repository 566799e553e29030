// burin/scene/blur.h - a Gaussian blur on the pixel grid. docs/model.md 5.7.
#pragma once

#include <vector>

#include "burin/base/image.h"

namespace burin {

/// Weights of a Gaussian on a pixel grid, odd in number, their sum 1. Pixels that are the mean of `bin` x `bin` finer
/// ones are as wide as the Gaussian or wider: there three taps of its variance say more than a sampled curve. Empty for
/// a sigma of 0.
std::vector<float> blur_taps(double psf_sigma_px, int bin = 1);

/// The image through those weights, along rows and columns; beyond the edge it goes on as it ends.
Image blurred(const Image& image, const std::vector<float>& taps);
Image blurred(const Image& image, double psf_sigma_px);

}  // namespace burin
