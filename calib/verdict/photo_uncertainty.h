// burin/calib/verdict/photo_uncertainty.h - how well photos determine what was fitted to them. The estimates are
// described in burin/calib/refine.h.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "burin/calib/photo/photo_problem.h"
#include "burin/scene/misfit.h"

namespace burin {

/// Covariances over all unknowns of a problem, in the order of global_index().
struct Uncertainty {
  std::vector<Eigen::MatrixXd> covariances;  ///< several estimates, over all unknowns; held ones are 0
  /// The normal equations that they were made from, in parts that could have been taken alone (views: all photos that
  /// share a pose), and the priors'. With the geometry known, all gradients add up to 0 at the optimum. For
  /// burin/calib/verdict/half_samples.h.
  std::vector<bool> free;
  std::vector<std::size_t> part_photo;  ///< index of the part's first photo, whose lamp stands for the part's
  std::vector<Eigen::MatrixXd> part_information;
  std::vector<Eigen::VectorXd> part_gradient;
  std::vector<Eigen::VectorXd> part_shift;  ///< by how much the answer moves without the part, the tags' hold included
  Eigen::VectorXd prior_information, prior_gradient;  ///< information: the diagonal
  /// The Cramer-Rao bound: what an unbiased fit of these unknowns to these pixels could reach if the camera's noise
  /// were all that is wrong with them, poses known. How far sigma() stands above it is what the model misses.
  Eigen::MatrixXd noise_bound;

  /// Of each view's camera center, board axes, by the same estimates but the jackknife: without its own photos a camera
  /// is where the tags have it. Empty where cameras did not move; 0 for a view without photos.
  std::vector<Eigen::Vector3d> center_sigma_mm;

  /// By how much the answer moves under choices that are as good as the one made, and between classes of pixels that
  /// contradict each other (model_tests.h); each counts as one sigma.
  std::vector<Eigen::VectorXd> shifts;
  /// Where photos and model contradict each other; how far that moves the answer is among the shifts.
  std::vector<Misfit> misfits;

  /// The largest of the estimates for the linear combination a, and the shifts.
  double sigma(const Eigen::VectorXd& a) const {
    double variance = 0;
    for (const Eigen::MatrixXd& c : covariances) variance = std::max(variance, a.dot(c * a));
    for (const Eigen::VectorXd& s : shifts) variance += a.dot(s) * a.dot(s);
    return std::sqrt(variance);
  }
  double sigma(int index) const { return sigma(Eigen::VectorXd::Unit(covariances.front().rows(), index)); }
  double bound(int index) const { return std::sqrt(noise_bound(index, index)); }
};

/// At the optimum `state` of what `stage` freed, poses, bow and lens (where the problem has a prior for them) included.
Uncertainty uncertainty_of(const Problem& data, const Stage& stage, const State& state);

}  // namespace burin
