#include "burin/calib/geometry/information.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>
#include <utility>

namespace burin {
namespace {

ScaledEigen eigen_at(const Eigen::MatrixXd& H, Eigen::VectorXd scale) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scale.asDiagonal() * H * scale.asDiagonal());
  return {std::move(scale), eigen.eigenvalues(), eigen.eigenvectors()};
}

Eigen::MatrixXd inverse_of(const ScaledEigen& eigen, double floor) {
  const Eigen::MatrixXd S = eigen.scale.asDiagonal() * eigen.vectors;
  return S * eigen.values.cwiseMax(floor).cwiseInverse().asDiagonal() * S.transpose();
}

Eigen::VectorXd unit_scale(const Eigen::MatrixXd& H) {
  Eigen::VectorXd scale = Eigen::VectorXd::Zero(H.rows());
  for (Eigen::Index i = 0; i < H.rows(); ++i)
    if (H(i, i) > 0) scale[i] = 1 / std::sqrt(H(i, i));
  return scale;
}

}  // namespace

ScaledEigen scaled_eigen(const Eigen::MatrixXd& H) { return eigen_at(H, unit_scale(H)); }

Eigen::MatrixXd inverse_information(const Eigen::MatrixXd& H, double floor) {
  return H.size() == 0 ? H : inverse_of(scaled_eigen(H), floor);
}

Eigen::MatrixXd safe_inverse(const Eigen::MatrixXd& H, const std::vector<bool>& free) {
  Eigen::VectorXd scale = unit_scale(H);
  for (Eigen::Index i = 0; i < H.rows(); ++i) {
    if (!free[i])
      scale[i] = 0;
    else if (!(H(i, i) > 0))
      scale[i] = 1;
  }
  return inverse_of(eigen_at(H, std::move(scale)), 1e-12);
}

Eigen::MatrixXd inverse_times(const Eigen::MatrixXd& A, const Eigen::MatrixXd& b) {
  const Eigen::VectorXd scale = A.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd inner = scale.asDiagonal() * A * scale.asDiagonal();
  return scale.asDiagonal() * inner.ldlt().solve(scale.asDiagonal() * b);
}

double chi_squared(const Eigen::VectorXd& terms, const Eigen::MatrixXd& covariance) {
  return terms.dot(inverse_times(covariance, terms).col(0));
}

}  // namespace burin
