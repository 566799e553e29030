#include "burin/calib/verdict/coupon_statistics.h"

#include <Eigen/Cholesky>
#include <cmath>

namespace burin {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Generalized least squares with some scatter added.
struct Solution {
  VectorXd x;
  MatrixXd covariance;
  double chi2 = 0;
};

Solution solve_with(const MatrixXd& design, const VectorXd& y, const MatrixXd& covariance, double scatter2) {
  MatrixXd V = covariance;
  V.diagonal().array() += scatter2;
  const Eigen::LDLT<MatrixXd> factor(V);
  const MatrixXd WX = factor.solve(design);
  Solution out;
  out.covariance = (design.transpose() * WX).ldlt().solve(MatrixXd::Identity(design.cols(), design.cols()));
  out.x = out.covariance * (WX.transpose() * y);
  const VectorXd left = y - design * out.x;
  out.chi2 = left.dot(factor.solve(left));
  return out;
}

// The added scatter's square for which chi^2 is its degrees of freedom; it falls as scatter grows.
double scatter_of(const MatrixXd& design, const VectorXd& y, const MatrixXd& covariance, int degrees) {
  if (degrees < 1 || solve_with(design, y, covariance, 0).chi2 <= degrees) return 0;
  double low = 0, high = 1e-6;
  while (solve_with(design, y, covariance, high).chi2 > degrees && high < 100) high *= 4;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (solve_with(design, y, covariance, middle).chi2 > degrees ? low : high) = middle;
  }
  return high;
}

}  // namespace

CellStatistics cell_statistics(const std::vector<FanSample>& samples, const MatrixXd& covariance, std::size_t cells) {
  CellStatistics out;
  out.cells.resize(cells);
  out.covariance = MatrixXd::Zero(static_cast<Index>(cells), static_cast<Index>(cells));
  const auto n = static_cast<Index>(samples.size());
  if (n == 0) return out;
  std::vector<Index> column(cells, -1);
  Index seen = 0;
  for (const FanSample& s : samples)
    if (column[s.cell] < 0) column[s.cell] = seen++;
  constexpr Index kTrends = 3;
  const bool trends = n - seen - kTrends >= 3;
  MatrixXd design = MatrixXd::Zero(n, seen + (trends ? kTrends : 0));
  VectorXd y(n);
  for (Index i = 0; i < n; ++i) {
    const FanSample& s = samples[static_cast<std::size_t>(i)];
    y[i] = s.value;
    design(i, column[s.cell]) = 1;
    if (trends) design.row(i).tail(kTrends) << s.age - 0.5, s.place.x(), s.place.y();
  }
  out.degrees = static_cast<int>(n - design.cols());
  out.chi2 = solve_with(design, y, covariance, 0).chi2;
  const double scatter2 = scatter_of(design, y, covariance, out.degrees);
  const Solution solution = solve_with(design, y, covariance, scatter2);
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
  if (trends) {
    out.wear = number(seen);
    out.tilt_x = number(seen + 1);
    out.tilt_y = number(seen + 2);
  }
  if (out.degrees >= 1) {
    // A variance from so many degrees of freedom, that of the photos being part of what was seen.
    const double seen2 = scatter2 + covariance.diagonal().mean(), spread = std::sqrt(2.0 / out.degrees) * seen2;
    const double scatter = std::sqrt(scatter2);
    out.repeat = {scatter, scatter > std::sqrt(spread) ? spread / (2 * scatter) : std::sqrt(spread), true};
  }
  return out;
}

}  // namespace burin
