#include "burin/calib/verdict/coupon_statistics.h"

#include <Eigen/Cholesky>
#include <cmath>

namespace burin {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Result of generalized least squares with additional scatter.
struct Solution {
  VectorXd x;
  MatrixXd covariance;
  double chi2 = 0;
  double log_likelihood = 0;  // of the scatter, with the fitted numbers marginalized
};

// The first `fans` rows have scatter; the later rows are priors.
Solution solve_with(const MatrixXd& design, const VectorXd& y, const MatrixXd& covariance, Index fans,
                    double scatter2) {
  MatrixXd V = covariance;
  V.diagonal().head(fans).array() += scatter2;
  const Eigen::LLT<MatrixXd> factor(V);
  const MatrixXd WX = factor.solve(design);
  const Eigen::LLT<MatrixXd> normal(design.transpose() * WX);
  Solution out;
  out.covariance = normal.solve(MatrixXd::Identity(design.cols(), design.cols()));
  out.x = out.covariance * (WX.transpose() * y);
  const VectorXd left = y - design * out.x;
  out.chi2 = left.dot(factor.solve(left));
  const auto half_log_determinant = [](const Eigen::LLT<MatrixXd>& of) {
    return of.matrixLLT().diagonal().array().log().sum();
  };
  out.log_likelihood = -0.5 * out.chi2 - half_log_determinant(factor) - half_log_determinant(normal);
  return out;
}

// Average over all plausible scatters, with an estimate of the scatter. Few repeats leave it uncertain, and this
// uncertainty belongs in every sigma.
Solution averaged(const MatrixXd& design, const VectorXd& y, const MatrixXd& covariance, Index fans,
                  Estimate& scatter) {
  constexpr int kSteps = 160;
  constexpr double kMost = 0.6, kUsual = 0.02, kUsualLog = 0.8;  // of logarithms; a lognormal prior
  std::vector<Solution> solutions;
  std::vector<double> at, weight;
  double best = -1e300;
  for (int i = 0; i < kSteps; ++i) {
    const double share = (i + 0.5) / kSteps, s = kMost * share * share;
    solutions.push_back(solve_with(design, y, covariance, fans, s * s));
    at.push_back(s);
    best = std::max(best, solutions.back().log_likelihood);
  }
  double sum = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double share = (i + 0.5) / kSteps, off = std::log(at[i] / kUsual) / kUsualLog,
                 prior = std::exp(-0.5 * off * off) / at[i];
    weight.push_back(share * prior * std::exp(solutions[i].log_likelihood - best));
    sum += weight.back();
  }
  Solution out = solutions.front();
  out.x.setZero();
  out.covariance.setZero();
  scatter = {0, 0, true};
  for (int i = 0; i < kSteps; ++i) {
    out.x += weight[i] / sum * solutions[i].x;
    scatter.value += weight[i] / sum * at[i];
  }
  for (int i = 0; i < kSteps; ++i) {
    const VectorXd off = solutions[i].x - out.x;
    out.covariance += weight[i] / sum * (solutions[i].covariance + off * off.transpose());
    scatter.sigma += weight[i] / sum * std::pow(at[i] - scatter.value, 2);
  }
  scatter.sigma = std::sqrt(scatter.sigma);
  return out;
}

}  // namespace

CellStatistics cell_statistics(const std::vector<FanSample>& samples, const MatrixXd& covariance, std::size_t cells,
                               const std::optional<TiltPrior>& tilt_prior) {
  CellStatistics out;
  out.cells.resize(cells);
  out.covariance = MatrixXd::Zero(static_cast<Index>(cells), static_cast<Index>(cells));
  const auto n = static_cast<Index>(samples.size());
  if (n == 0) return out;
  std::vector<Index> column(cells, -1);
  Index seen = 0;
  for (const FanSample& s : samples)
    if (column[s.cell] < 0) column[s.cell] = seen++;
  constexpr Index kFewestLeft = 2;
  const Index wear = n - seen - 1 >= kFewestLeft ? 1 : 0, tilt = tilt_prior ? 2 : 0;
  MatrixXd design = MatrixXd::Zero(n + tilt, seen + wear + tilt);
  VectorXd y = VectorXd::Zero(n + tilt);
  for (Index i = 0; i < n; ++i) {
    const FanSample& s = samples[static_cast<std::size_t>(i)];
    y[i] = s.value;
    design(i, column[s.cell]) = 1;
    if (wear > 0) design(i, seen) = s.age - 0.5;
    if (tilt > 0) design.row(i).tail<2>() = s.place.transpose();
  }
  MatrixXd errors = MatrixXd::Zero(n + tilt, n + tilt);
  errors.topLeftCorner(n, n) = covariance;
  for (Index i = 0; i < tilt; ++i) {
    design(n + i, seen + wear + i) = 1;
    y[n + i] = tilt_prior->value[i];
    errors(n + i, n + i) = tilt_prior->sigma[i] * tilt_prior->sigma[i];
  }
  out.degrees = static_cast<int>(n - seen - wear);
  out.chi2 = solve_with(design, y, errors, n, 0).chi2;
  const Solution solution =
      out.degrees > 0 ? averaged(design, y, errors, n, out.repeat) : solve_with(design, y, errors, n, 0);
  const auto number = [&](Index at) {
    return Estimate{solution.x[at], std::sqrt(std::max(0.0, solution.covariance(at, at))), true};
  };
  for (std::size_t a = 0; a < cells; ++a) {
    if (column[a] < 0) continue;
    out.cells[a] = number(column[a]);
    for (std::size_t b = 0; b < cells; ++b)
      if (column[b] >= 0)
        out.covariance(static_cast<Index>(a), static_cast<Index>(b)) = solution.covariance(column[a], column[b]);
  }
  if (wear > 0) out.wear = number(seen);
  if (tilt > 0) out.tilt_x = number(seen + wear), out.tilt_y = number(seen + wear + 1);
  return out;
}

}  // namespace burin
