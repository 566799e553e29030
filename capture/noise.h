// burin/capture/noise.h - noise of photos, estimated from the photos themselves.
//
// The model for a linear value v (1: white level) follows the noise of docs/model.md 5.9 (Poisson electrons, Gaussian
// read noise):
//   variance(v) = photon v + read + stored step(v)^2,
// step(v) is the linear width of one stored level at v: constant for linear files, growing with brightness for sRGB
// ones. `stored` is at least 1/12 (rounding); the data determine JPEG's contribution.
//
// Sources of the estimate, per level of brightness:
// - two exposures of one view: their difference at the common scale holds noise only. A nonzero median is a wrong
// exposure time and does not count as noise;
// - one exposure: second differences between neighbors. The quietest blocks count; texture makes the estimate too
// large.
#pragma once

#include <span>
#include <vector>

#include "burin/capture/linear_photo.h"

namespace burin {

/// Linear width of one stored level around the linear value `v`.
double linear_step(const StoredAs& stored, double v);

/// Variance of a linear value v: photon v + read + stored step^2, 1 being the white level. docs/model.md 5.
struct NoiseModel {
  double photon = 1e-4;        ///< 1 / (electrons at the white level)
  double read = 1e-7;          ///< variance
  double stored = 1.0 / 12.0;  ///< in units of step^2

  /// Variance of a value v (1: the white level) with that quantization.
  double variance(double v, const StoredAs& kept) const;
};

/// One measured variance, at the mean value `v` of an exposure. The coefficients belong to the model's three terms.
struct NoiseSample {
  double coefficient[3];  ///< of photon, read, stored
  double variance;
  double weight;  ///< number of independent values behind it
};

/// Measures noise between a longer and a shorter exposure of one view. `ratio` is exposure factor short / long (< 1).
/// Pixels at or next to a clipped pixel of either photo are left out.
std::vector<NoiseSample> noise_between(const LinearPhoto& longer, const LinearPhoto& shorter, double ratio);

/// Measures noise within one photo.
std::vector<NoiseSample> noise_within(const LinearPhoto& photo);

/// Least squares with no negative term, relative residuals. Returns the defaults without samples.
NoiseModel fit_noise(std::span<const NoiseSample> samples);

}  // namespace burin
