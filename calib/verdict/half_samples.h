// burin/calib/verdict/half_samples.h - what halves of the photos say by themselves, against each other: a check that a
// sigma is honest.
//
// A solved least-squares problem whose data come in parts (photos) leaves each part's normal equations at the optimum:
// information H_k = J^T W J and gradient g_k = J^T W r. Solving again without some parts costs nothing then: the
// optimum of a half A is, to first order, x - (P + sum H_k)^-1 (g_P + sum g_k), the sums over A and P the priors. That
// is a step of Gauss and Newton from the optimum of all, exact where the model is linear (docs/model.md 9.19).
//
// Halves are balanced half-samples (McCarthy, Review of the International Statistical Institute 37, 1969): photos are
// paired with those most like them, each half takes one of each pair, as the rows of a Hadamard matrix say. So both
// halves see the bench from everywhere, all pairs weigh alike, and for a linear model the mean of (x_A - x_B)^2 / 4 is
// an estimate of the variance of the whole with as many degrees of freedom as there are pairs.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <utility>
#include <vector>

namespace burin {

/// A solved problem in parts that could have been taken alone.
struct EquationsInParts {
  std::vector<Eigen::MatrixXd> information;  ///< one a part, n x n
  std::vector<Eigen::VectorXd> gradient;     ///< J^T W r of each, n
  Eigen::MatrixXd prior;                     ///< n x n
  Eigen::VectorXd prior_gradient;
  std::vector<std::pair<std::size_t, std::size_t>>
      pairs;  ///< parts that are alike; a part in no pair is in both halves
};

/// The halves' optima, as steps from the optimum of all, and their information's inverses.
struct HalfSamples {
  struct Split {
    Eigen::VectorXd step_a, step_b;
    Eigen::MatrixXd inverse_a, inverse_b;
  };
  std::vector<Split> splits;                      ///< empty where there are fewer than two pairs
  Eigen::MatrixXd inverse;                        ///< of all
  std::vector<Eigen::MatrixXd> pair_information;  ///< of both photos of each pair
};

HalfSamples half_samples(const EquationsInParts& equations);

/// What the halves say of the linear combination a of the parameters.
struct HalvesVerdict {
  /// Degrees of freedom (Satterthwaite's): the number of pairs, less where some carry the parameter and others do not.
  /// 0: could not be compared.
  double degrees = 0;
  /// Root mean square, over the splits, of the halves' difference over its expected sigma, that being what `sigma` of
  /// the whole makes it. 1 where sigma is right.
  double ratio = 0;
  double limit = 0;  ///< what chance alone lets the ratio exceed once in a thousand times
  /// How many times less a half knows than the whole, worst over the splits: about 1.4 where photos weigh alike; large
  /// where one or two photos carry the parameter.
  double half_to_whole = 0;

  bool contradict() const { return degrees > 0 && ratio > limit; }
};
HalvesVerdict compare_halves(const HalfSamples& halves, const Eigen::VectorXd& a, double sigma);

/// Pairs of neighbors in the order of `key` (photos with keys alike go together), within each `group`.
std::vector<std::pair<std::size_t, std::size_t>> pair_neighbors(const std::vector<double>& key,
                                                                const std::vector<std::size_t>& group);

}  // namespace burin
