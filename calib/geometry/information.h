// burin/calib/geometry/information.h - information matrices (inverse covariances, normal matrices) of unknowns with
// very different units. Inversion scales the diagonal to 1 first.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace burin {

/// Decomposition of a symmetric H as D V diag(values) V^T D, with D the root of its diagonal.
struct ScaledEigen {
  Eigen::VectorXd scale;   ///< 1 / D; 0 for unknowns without information
  Eigen::VectorXd values;  ///< ascending
  Eigen::MatrixXd vectors;
};
ScaledEigen scaled_eigen(const Eigen::MatrixXd& H);

/// H^-1, with zeros for unknowns without information (a diagonal of 0). Directions without information have a huge
/// sigma instead of NaN: eigenvalues below `floor` at a unit diagonal, the level of rounding.
Eigen::MatrixXd inverse_information(const Eigen::MatrixXd& H, double floor = 1e-12);

/// inverse_information() of the `free` unknowns; zeros for the others. A free unknown without information has a huge
/// variance.
Eigen::MatrixXd safe_inverse(const Eigen::MatrixXd& H, const std::vector<bool>& free);

/// terms^T C^-1 terms: squared distance of the terms from 0 in units of their covariance.
double chi_squared(const Eigen::VectorXd& terms, const Eigen::MatrixXd& covariance);

/// A^-1 b for a positive definite A.
Eigen::MatrixXd inverse_times(const Eigen::MatrixXd& A, const Eigen::MatrixXd& b);

}  // namespace burin
