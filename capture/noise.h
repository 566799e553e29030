// burin/capture/noise.h - how noisy photos are, from the photos themselves.
//
// Model, for a linear value v (1: white level), after the noise of docs/model.md 5.9 (Poisson electrons, Gaussian read
// noise):
//   variance(v) = photon v + read + stored step(v)^2,
// step(v) being the linear width of one stored level at v: constant for linear files, wider in the light for sRGB ones.
// `stored` is at least 1/12 (rounding); what JPEG adds to it comes from the data.
//
// Sources of the estimate, per level of brightness:
// - two exposures of one view: their difference at the common scale holds no picture, only noise (and, as a median that
//   is not zero, a wrong exposure time, which is not counted as noise);
// - one exposure: second differences between neighbors, of which the quietest blocks count; texture makes it too
// large.
#pragma once

#include <span>
#include <vector>

#include "burin/capture/linear_photo.h"

namespace burin {

/// Linear width of one stored level around the linear value `v`.
double linear_step(const StoredAs& stored, double v);

/// Variance of a linear value v: photon v + read + stored step^2, 1 being the white level: docs/model.md 5.
struct NoiseModel {
  double photon = 1e-4;        ///< 1 / (electrons at the white level)
  double read = 1e-7;          ///< variance
  double stored = 1.0 / 12.0;  ///< in units of step^2

  /// Of a value v (1: the white level) that was stored so.
  double variance(double v, const StoredAs& kept) const;
};

/// One measured variance: at mean value `v` of an exposure, for a sum with the coefficients of the model's three terms.
struct NoiseSample {
  double coefficient[3];  ///< of photon, read, stored
  double variance;
  double weight;  ///< number of independent values behind it
};

/// Measures noise between a longer and a shorter exposure of one view; `ratio` is exposure factor short / long (< 1).
/// Pixels that either photo marks as clipped (or next to such) are left out.
std::vector<NoiseSample> noise_between(const LinearPhoto& longer, const LinearPhoto& shorter, double ratio);

/// Measures noise within one photo.
std::vector<NoiseSample> noise_within(const LinearPhoto& photo);

/// Least squares with no negative term, relative residuals. Without samples: the defaults.
NoiseModel fit_noise(std::span<const NoiseSample> samples);

}  // namespace burin
