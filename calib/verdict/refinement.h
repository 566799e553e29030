// burin/calib/verdict/refinement.h - the result of burin/calib/refine.h.
// Frame: board, mm.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

#include "burin/base/finding.h"
#include "burin/scene/bench.h"
#include "burin/scene/verdict.h"

namespace burin {

/// Fit of one photo (a view under one lamp, exposures merged).
struct PhotoFit {
  std::string view, light;
  std::size_t pixels = 0;   ///< used
  double residual_rms = 0;  ///< of photo - prediction, linear, relative to the photo's RMS value; outliers excluded
  double residual_to_noise = 0;  ///< robust RMS of residual / the photo's own noise: 1 for a perfect model
  double outliers = 0;           ///< fraction of pixels beyond 4 sigma of noise and model error
};

/// A reported sigma and the Cramer-Rao bound of white noise; the excess is model error.
struct NoiseBound {
  std::string name;  ///< as in the verdict
  double sigma = 0, bound = 0;
  Unit unit = Unit::none;
};

/// How the errors of the numbers that the photos determine go together. The covariance of two of them is their
/// correlation times both sigmas.
struct Correlations {
  /// A number of the bench: "alpha", "light.ID.position_mm[0]", "machine.affine[1][2]"; its unit ("um"); its sigma.
  struct Number {
    std::string name, unit;
    double sigma = 0;
  };
  std::vector<Number> numbers;
  Eigen::MatrixXd values;  ///< one row and one column per number; 1 on the diagonal
};

/// Result of refine(): the measured setup, its uncertainties and diagnostics.
struct Refinement {
  Bench bench;  ///< completed: material, lights, sensor, ambient, machine_affine, sigmas, verdict
  std::vector<PhotoFit> photos;
  double model_error = 0;  ///< relative model error beyond noise, from the residuals
  /// Groove-to-groove variation of roughness and depth from the residuals: sigmas of their logarithms.
  double alpha_jitter = 0, depth_jitter = 0;
  /// Scatter of pixels along their slopes by log alpha and log depth, with groove-to-groove variation
  /// (photo_problem.h).
  Eigen::Vector2d slope_error{0, 0};
  double looked_at = 1;  ///< fraction of the carve area in use: on a crowded board only squares
  int bin = 1;           ///< merged pixels per side of one pixel of the finest fit
  Correlations correlations;
  std::vector<NoiseBound> noise_bounds;    ///< of the fitted ones among alpha, base_alpha, depth_um and the lamps
  std::vector<std::string> other_grooves;  ///< views whose photos show other grooves than the scratches'
  std::vector<Finding> findings;           ///< omitted data and suspicious results
};

}  // namespace burin
