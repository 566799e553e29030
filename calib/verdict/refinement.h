// burin/calib/verdict/refinement.h - what burin/calib/refine.h finds. Frame: board, mm.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

#include "burin/base/finding.h"
#include "burin/scene/bench.h"
#include "burin/scene/verdict.h"

namespace burin {

/// How one photo (a view under one lamp, exposures merged) is explained.
struct PhotoFit {
  std::string view, light;
  std::size_t pixels = 0;   ///< used
  double residual_rms = 0;  ///< of photo - prediction, linear, relative to the photo's RMS value; outliers excluded
  double residual_to_noise = 0;  ///< robust RMS of residual / the photo's own noise: 1 where the model is perfect
  double outliers = 0;           ///< fraction of pixels beyond 4 sigma of noise and model error
};

/// A reported sigma beside the Cramer-Rao bound of white noise: the rest is what the model misses.
struct NoiseBound {
  std::string name;  ///< as in the verdict
  double sigma = 0, bound = 0;
  Unit unit = Unit::none;
};

struct Refinement {
  Bench bench;  ///< completed: material, lights, sensor, ambient, machine_affine, sigmas, verdict
  std::vector<PhotoFit> photos;
  double model_error = 0;  ///< relative, what the residuals say that the model misses beyond noise
  /// How much roughness and depth differ from groove to groove, as the residuals say: sigmas of their logarithms.
  double alpha_jitter = 0, depth_jitter = 0;
  /// What pixels scatter along their slopes by log alpha and log depth, grooves' differences included
  /// (photo_problem.h).
  Eigen::Vector2d slope_error{0, 0};
  double looked_at = 1;                    ///< share of the carve area that counts: of a crowded board only squares do
  int bin = 1;                             ///< merged pixels, either way, in one of the fit's at its finest
  std::vector<NoiseBound> noise_bounds;    ///< of alpha, base_alpha, depth_um and the lamps, as far as they were fitted
  std::vector<std::string> other_grooves;  ///< views whose photos show other grooves than the scratches'
  std::vector<Finding> findings;           ///< what was left out, what looks wrong
};

}  // namespace burin
