// burin/scene/blur.h - a Gaussian blur on the pixel grid. docs/model.md 5.7.
#pragma once

#include <vector>

#include "burin/base/image.h"

namespace burin {

/// Weights of a Gaussian on a pixel grid: an odd number, with sum 1; empty for a sigma of 0. Each pixel is the mean of
/// `bin` x `bin` finer ones. If it is as wide as the Gaussian or wider, three taps with the Gaussian's variance are
/// more accurate than a sampled curve.
std::vector<float> blur_taps(double psf_sigma_px, int bin = 1);

/// Convolves the image with those weights along rows and columns. Border pixels continue beyond the edge.
Image blurred(const Image& image, const std::vector<float>& taps);
Image blurred(const Image& image, double psf_sigma_px);

}  // namespace burin
