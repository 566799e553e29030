// burin/calib/verdict/photo_uncertainty.h - uncertainty of parameters fitted to photos. burin/calib/refine.h describes
// the estimates.
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
  std::vector<Eigen::MatrixXd> covariances;  ///< several estimates, over all unknowns; fixed unknowns are 0
  /// The priors' normal equations, and the data's, in parts that could have been taken alone (views: all photos with
  /// one pose). With known geometry, all gradients add up to 0 at the optimum. For burin/calib/verdict/half_samples.h.
  std::vector<bool> free;
  std::vector<std::size_t> part_photo;  ///< index of the part's first photo, whose lamp represents the part
  std::vector<Eigen::MatrixXd> part_information;
  std::vector<Eigen::VectorXd> part_gradient;
  std::vector<Eigen::VectorXd> part_shift;  ///< shift of the estimates without the part, with the tags' constraint
  Eigen::VectorXd prior_information, prior_gradient;  ///< information: the diagonal
  /// Cramer-Rao bound: the limit for an unbiased fit of these unknowns to these pixels with only the camera's noise and
  /// known poses. The excess of sigma() over it is due to model error.
  Eigen::MatrixXd noise_bound;

  /// Sigma of each view's camera center, board axes, by the same estimates except the jackknife: without its own
  /// photos, the tags alone determine a camera. Empty if cameras were fixed; 0 for a view without photos.
  std::vector<Eigen::Vector3d> center_sigma_mm;

  /// Shifts of the estimates under equally good choices, and between classes of pixels that contradict each other
  /// (model_tests.h); each counts as one sigma.
  std::vector<Eigen::VectorXd> shifts;
  /// Contradictions between photos and model; their effects on the estimates are among the shifts.
  std::vector<Misfit> misfits;

  /// The largest of the estimates for the linear combination a, combined with the shifts.
  double sigma(const Eigen::VectorXd& a) const {
    double variance = 0;
    for (const Eigen::MatrixXd& c : covariances) variance = std::max(variance, a.dot(c * a));
    for (const Eigen::VectorXd& s : shifts) variance += a.dot(s) * a.dot(s);
    return std::sqrt(variance);
  }
  double sigma(int index) const { return sigma(Eigen::VectorXd::Unit(covariances.front().rows(), index)); }
  double bound(int index) const { return std::sqrt(noise_bound(index, index)); }
};

/// At the optimum `state` of the unknowns that `stage` freed, with poses, bow and lens (if the problem has a prior for
/// them).
Uncertainty uncertainty_of(const Problem& data, const Stage& stage, const State& state);

}  // namespace burin
