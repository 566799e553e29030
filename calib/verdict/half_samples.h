// burin/calib/verdict/half_samples.h - comparison of estimates from halves of the photos: a check of the reported
// sigmas.
//
// A solved least-squares problem with data in parts (photos) has normal equations per part at the optimum: information
// H_k = J^T W J and gradient g_k = J^T W r. They make a solution without some parts cheap. To first order, the optimum
// of a half A is x - (P + sum H_k)^-1 (g_P + sum g_k), with sums over A and the priors P. This is a Gauss-Newton step
// from the optimum of all parts, exact for a linear model (docs/model.md 9.19).
//
// Halves are balanced half-samples (McCarthy, Review of the International Statistical Institute 37, 1969). Photos are
// paired with the most similar ones, and each half takes one of each pair, as the rows of a Hadamard matrix prescribe.
// Both halves then cover all viewpoints, and all pairs have equal weight.
// For a linear model, the mean of (x_A - x_B)^2 / 4 estimates the variance of the whole, with as many degrees of
// freedom as pairs.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <utility>
#include <vector>

namespace burin {

/// A solved problem in parts that could have been taken alone.
struct EquationsInParts {
  std::vector<Eigen::MatrixXd> information;  ///< n x n per part
  std::vector<Eigen::VectorXd> gradient;     ///< J^T W r per part, n
  Eigen::MatrixXd prior;                     ///< n x n
  Eigen::VectorXd prior_gradient;
  std::vector<std::pair<std::size_t, std::size_t>> pairs;  ///< similar parts; an unpaired part is in both halves
};

/// The halves' optima, as steps from the optimum of all parts, and the inverses of their information.
struct HalfSamples {
  struct Split {
    Eigen::VectorXd step_a, step_b;
    Eigen::MatrixXd inverse_a, inverse_b;
  };
  std::vector<Split> splits;                      ///< empty for fewer than two pairs
  Eigen::MatrixXd inverse;                        ///< of all parts
  std::vector<Eigen::MatrixXd> pair_information;  ///< of both photos of each pair
};

HalfSamples half_samples(const EquationsInParts& equations);

/// Comparison of the halves for the linear combination a of the parameters.
struct HalvesVerdict {
  /// Degrees of freedom (Satterthwaite's): the number of pairs, reduced if only some pairs inform about the parameter.
  /// 0: comparison impossible.
  double degrees = 0;
  /// Root mean square, over the splits, of the halves' difference divided by its expected sigma, which follows from
  /// `sigma` of the whole. 1 for a correct sigma.
  double ratio = 0;
  double limit = 0;  ///< ratio that chance alone exceeds once in a thousand cases
  /// Largest ratio, over the splits, of a half's sigma to the sigma of the whole: about 1.4 for photos of equal weight;
  /// large if one or two photos determine the parameter.
  double half_to_whole = 0;

  bool contradict() const { return degrees > 0 && ratio > limit; }
};
HalvesVerdict compare_halves(const HalfSamples& halves, const Eigen::VectorXd& a, double sigma);

/// Pairs of neighbors in the order of `key` (photos with similar keys form pairs), within each `group`.
std::vector<std::pair<std::size_t, std::size_t>> pair_neighbors(const std::vector<double>& key,
                                                                const std::vector<std::size_t>& group);

}  // namespace burin
