#include "burin/calib/photo/geometry_agreement.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <vector>

#include "burin/calib/geometry/information.h"

namespace burin {
namespace {

// A direction in the geometry: the pixels' information over the tags', their score at the tags' optimum, and its
// scatter over squares of the board.
struct Direction {
  double mu, gamma, scatter;
};

std::vector<Direction> directions_of(const NormalSystem& system, const GeometryPrior& prior) {
  constexpr double kNextToNothing = 1e-3;
  const Eigen::Index n = system.H.rows(), m = system.A.rows();
  // The photos' own information and scores, all other unknowns eliminated.
  const Eigen::MatrixXd H = system.H + system.gain * system.B.transpose();
  const Eigen::MatrixXd by_unknowns = safe_inverse(H, system.free) * system.B;
  const auto eliminated = [&](const Eigen::MatrixXd& unknowns, const Eigen::MatrixXd& geometry) {
    return Eigen::MatrixXd(geometry - by_unknowns.transpose() * (unknowns + system.gain * geometry));
  };
  const Eigen::MatrixXd weighted = prior.weight * prior.information;
  const Eigen::MatrixXd G = system.A - weighted - system.B.transpose() * by_unknowns;
  const Eigen::VectorXd unknowns_g = system.g + system.gain * (weighted * system.geometry_off);
  const Eigen::VectorXd score =
      eliminated(unknowns_g, system.geometry_g - weighted * system.geometry_off) - G * system.geometry_off;
  const Eigen::MatrixXd squares = eliminated(system.tiles.topRows(n), system.tiles.bottomRows(m));

  const Eigen::VectorXd scale = prior.information.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::LLT<Eigen::MatrixXd> root(scale.asDiagonal() * prior.information * scale.asDiagonal());
  const auto in_sigmas = [&](const Eigen::MatrixXd& x) {
    return Eigen::MatrixXd(root.matrixL().solve(Eigen::MatrixXd(scale.asDiagonal() * x)));
  };
  const Eigen::MatrixXd ratio = in_sigmas(in_sigmas(G).transpose());
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(0.5 * (ratio + ratio.transpose()));
  const Eigen::VectorXd gamma = eigen.eigenvectors().transpose() * in_sigmas(score);
  const Eigen::VectorXd scatter = (eigen.eigenvectors().transpose() * in_sigmas(squares)).rowwise().squaredNorm();
  std::vector<Direction> out;
  for (Eigen::Index i = 0; i < m; ++i)
    if (eigen.eigenvalues()[i] > kNextToNothing) out.push_back({eigen.eigenvalues()[i], gamma[i], scatter[i]});
  return out;
}

// s: factor on the pixels' variances that makes the distance equal to the number of directions.
double stretch_of(const std::vector<Direction>& directions) {
  constexpr double kMost = 1e12;
  const auto distance = [&](double s) {
    double sum = 0;
    for (const Direction& d : directions) sum += d.gamma * d.gamma / (d.mu * (s + d.mu));
    return sum;
  };
  const auto count = static_cast<double>(directions.size());
  double low = 1, high = 1;
  while (distance(high) > count && high < kMost) high *= 2;
  constexpr int kHalvings = 50;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = std::sqrt(low * high);
    (distance(middle) > count ? low : high) = middle;
  }
  return high;
}

}  // namespace

double tags_weight(const NormalSystem& system, const GeometryPrior& prior) {
  constexpr double kChance = 4;  // sigmas
  const std::vector<Direction> directions = directions_of(system, prior);
  const auto count = static_cast<double>(directions.size());
  double apart = 0;
  for (const Direction& d : directions) apart += d.gamma * d.gamma / (d.scatter + d.mu * d.mu);
  const double beyond_chance = apart / (count + kChance * std::sqrt(2 * count)) - 1;
  if (directions.empty() || beyond_chance <= 0) return 1;
  return std::pow(stretch_of(directions), std::min(1.0, beyond_chance));
}

}  // namespace burin
