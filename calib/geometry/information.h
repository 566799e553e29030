// burin/calib/geometry/information.h - matrices of information (inverse covariances; normal matrices) whose unknowns
// have very different units: inverses by way of a unit diagonal.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace burin {

/// A symmetric H as D V diag(values) V^T D, with D the root of its diagonal.
struct ScaledEigen {
  Eigen::VectorXd scale;   ///< 1 / D; 0 for unknowns without information
  Eigen::VectorXd values;  ///< rising
  Eigen::MatrixXd vectors;
};
ScaledEigen scaled_eigen(const Eigen::MatrixXd& H);

/// H^-1, with zeros for unknowns of which there is no information (a diagonal of 0). Directions that H knows nothing of
/// (eigenvalues below `floor` at a unit diagonal, rounding's level) come out with a huge sigma instead of NaN.
Eigen::MatrixXd inverse_information(const Eigen::MatrixXd& H, double floor = 1e-12);

/// As inverse_information() of the `free` unknowns; zeros for the others. A free one without information gets a huge
/// variance.
Eigen::MatrixXd safe_inverse(const Eigen::MatrixXd& H, const std::vector<bool>& free);

/// terms^T C^-1 terms: how far terms of that covariance are from 0.
double chi_squared(const Eigen::VectorXd& terms, const Eigen::MatrixXd& covariance);

/// A^-1 b for a positive definite A.
Eigen::MatrixXd inverse_times(const Eigen::MatrixXd& A, const Eigen::MatrixXd& b);

}  // namespace burin
