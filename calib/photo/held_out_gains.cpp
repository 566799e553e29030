#include "burin/calib/photo/held_out_gains.h"

#include <cmath>
#include <numeric>

#include "burin/calib/geometry/information.h"

namespace burin {

std::vector<double> held_out_gains(const ViewEquations& e, const Eigen::MatrixXd& H, const Eigen::VectorXd& g,
                                   const std::vector<bool>& free, const std::vector<Eigen::Index>& added) {
  const auto n = static_cast<Eigen::Index>(added.size());
  Eigen::MatrixXd pick = Eigen::MatrixXd::Zero(n, H.cols());
  for (Eigen::Index a = 0; a < n; ++a) pick(a, added[a]) = 1;
  const Eigen::MatrixXd follow = pick - pick * H * safe_inverse(H, free);  // the others eliminated
  const Eigen::MatrixXd information = follow * H * follow.transpose();
  const Eigen::VectorXd score = follow * g;
  std::vector<double> out;
  for (std::size_t k = 0; k < e.H.size(); ++k) {
    const Eigen::MatrixXd own = follow * e.H[k] * follow.transpose();
    const Eigen::VectorXd own_score = follow * e.g[k];
    const Eigen::VectorXd terms = -inverse_times(information - own, score - own_score);
    out.push_back(-own_score.dot(terms) - 0.5 * terms.dot(own * terms));
  }
  return out;
}

Gain gain_of(const std::vector<double>& of_views) {
  const auto n = static_cast<double>(of_views.size());
  Gain out;
  out.sum = std::accumulate(of_views.begin(), of_views.end(), 0.0);
  double scatter = 0;
  for (const double one : of_views) scatter += std::pow(one - out.sum / n, 2);
  out.standard_error = std::sqrt(n / (n - 1) * scatter);
  return out;
}

Gain gain_between(const std::vector<double>& less, const std::vector<double>& more) {
  std::vector<double> gains(less);
  for (std::size_t k = 0; k < gains.size(); ++k) gains[k] -= more[k];
  return gain_of(gains);
}

}  // namespace burin
