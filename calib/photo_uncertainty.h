// calib/photo_uncertainty.h - how well photos determine what was fitted to them. See refine.h for the three estimates.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "calib/photo_problem.h"

namespace burin {

/// Covariances over all unknowns of a problem, in the order of global_index().
struct Uncertainty {
  std::vector<Eigen::MatrixXd> covariances;  ///< three estimates, over all unknowns; held ones are 0
  /// The normal equations that they were made from, in parts that could have been taken alone (photos), and the
  /// priors'. All gradients add up to 0 at the optimum. For calib/half_samples.h.
  std::vector<bool> free;
  std::vector<std::size_t> part_photo;  ///< index of a photo of the part
  std::vector<Eigen::MatrixXd> part_information;
  std::vector<Eigen::VectorXd> part_gradient;
  Eigen::VectorXd prior_information, prior_gradient;  ///< information: the diagonal

  /// The largest of the estimates for the linear combination a.
  double sigma(const Eigen::VectorXd& a) const {
    double variance = 0;
    for (const Eigen::MatrixXd& c : covariances) variance = std::max(variance, a.dot(c * a));
    return std::sqrt(variance);
  }
  double sigma(int index) const { return sigma(Eigen::VectorXd::Unit(covariances.front().rows(), index)); }
};

/// At the optimum `state` of what `stage` freed.
Uncertainty uncertainty_of(const Problem& data, const Stage& stage, State& state, std::size_t light_count);

}  // namespace burin
