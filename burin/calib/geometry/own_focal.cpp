#include "burin/calib/geometry/own_focal.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>

namespace burin {
namespace {

constexpr int kOwn = 7;  // rotation, translation, log focal length
using OwnVector = Eigen::Matrix<double, kOwn, 1>;

struct OwnCorners {
  std::vector<Eigen::Vector3d> p_mm;  // on the board
  std::vector<Eigen::Vector2d> q_px;
  std::vector<double> sigma_px;
};

Eigen::VectorXd residuals_at(const OwnCorners& corners, const Lens& lens, const Eigen::Isometry3d& T,
                             double log_focal) {
  Lens own = lens;
  own.intrinsics[0] *= std::exp(log_focal);
  own.intrinsics[1] *= std::exp(log_focal);
  std::vector<Eigen::Vector3d> v;
  for (const Eigen::Vector3d& p : corners.p_mm) v.emplace_back(T * p);
  std::vector<Eigen::Vector2d> q(v.size());
  project(own, v, q);
  Eigen::VectorXd r(2 * static_cast<Eigen::Index>(q.size()));
  for (std::size_t i = 0; i < q.size(); ++i)
    r.segment<2>(2 * static_cast<Eigen::Index>(i)) = (q[i] - corners.q_px[i]) / corners.sigma_px[i];
  return r;
}

Eigen::Isometry3d moved(const Eigen::Isometry3d& T, const OwnVector& x) {
  Eigen::Isometry3d out = T;
  const Eigen::Vector3d turn = x.head<3>();
  if (turn.norm() > 0) out.linear() = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix() * T.linear();
  out.translation() += x.segment<3>(3);
  return out;
}

std::optional<OwnFocal> own_focal(const OwnCorners& corners, const Lens& lens, Eigen::Isometry3d T) {
  constexpr std::size_t kFewestCorners = 12;
  if (corners.p_mm.size() < kFewestCorners) return std::nullopt;
  const double distance_mm = (T * corners.p_mm.front()).norm();
  const std::array<double, kOwn> step{1e-5, 1e-5, 1e-5, 1e-5 * distance_mm, 1e-5 * distance_mm, 1e-5 * distance_mm,
                                      1e-5};
  double log_focal = 0;
  constexpr int kRounds = 8;
  Eigen::Matrix<double, kOwn, kOwn> H;
  double chi2 = 0;
  for (int round = 0; round <= kRounds; ++round) {
    const Eigen::VectorXd r = residuals_at(corners, lens, T, log_focal);
    if (!r.allFinite()) return std::nullopt;
    Eigen::MatrixXd J(r.size(), kOwn);
    for (int k = 0; k < kOwn; ++k) {
      OwnVector x = OwnVector::Zero();
      x[k] = step[static_cast<std::size_t>(k)];
      J.col(k) = (residuals_at(corners, lens, moved(T, x), log_focal + x[6]) - r) / x[k];
    }
    if (!J.allFinite()) return std::nullopt;
    // Corners that contradict the view itself: their weight falls as Cauchy's.
    constexpr double kRobust = 3;
    Eigen::VectorXd weight = (1 + r.array().square() / (kRobust * kRobust)).inverse().matrix();
    if (round == 0) weight.setOnes();
    H = J.transpose() * weight.asDiagonal() * J;
    const Eigen::LDLT<Eigen::Matrix<double, kOwn, kOwn>> solver(H);
    chi2 = (weight.array() * r.array().square()).sum() / std::max(1.0, weight.sum() - kOwn);
    if (round == kRounds) break;
    OwnVector x = -solver.solve(J.transpose() * weight.asDiagonal() * r);
    if (!x.allFinite()) return std::nullopt;
    constexpr double kLongest = 0.3;
    if (std::abs(x[6]) > kLongest) x *= kLongest / std::abs(x[6]);
    T = moved(T, x);
    log_focal += x[6];
  }
  const Eigen::Matrix<double, kOwn, kOwn> covariance =
      H.ldlt().solve(Eigen::Matrix<double, kOwn, kOwn>::Identity()) * std::max(chi2, 1.0);
  if (!(covariance(6, 6) > 0)) return std::nullopt;
  return OwnFocal{log_focal, std::sqrt(covariance(6, 6))};
}

}  // namespace

std::vector<std::optional<OwnFocal>> own_focals(const Bundle& bundle) {
  std::vector<OwnCorners> of_view(bundle.views.size());
  for (const BundleCorner& corner : bundle.corners) {
    OwnCorners& own = of_view[static_cast<std::size_t>(corner.view)];
    own.p_mm.push_back(bundle_point_mm(bundle, corner));
    own.q_px.push_back(corner.q_px);
    own.sigma_px.push_back(corner.sigma_px);
  }
  std::vector<std::optional<OwnFocal>> out;
  for (std::size_t v = 0; v < of_view.size(); ++v) out.push_back(own_focal(of_view[v], bundle.lens, bundle.views[v]));
  return out;
}

double focal_scatter(const std::vector<std::optional<OwnFocal>>& focals, const std::vector<bool>& counts) {
  constexpr double kUseful = 0.05;  // a sigma beyond which a view tells nothing
  std::vector<OwnFocal> known;
  for (std::size_t v = 0; v < focals.size(); ++v)
    if (counts[v] && focals[v] && focals[v]->sigma < kUseful) known.push_back(*focals[v]);
  constexpr std::size_t kFewest = 4;
  if (known.size() < kFewest) return 0;
  double weights = 0, mean = 0;
  for (const OwnFocal& f : known) weights += 1 / (f.sigma * f.sigma), mean += f.log_ratio / (f.sigma * f.sigma);
  mean /= weights;
  double chi2 = 0;
  for (const OwnFocal& f : known) chi2 += (f.log_ratio - mean) * (f.log_ratio - mean) / (f.sigma * f.sigma);
  const auto freedom = static_cast<double>(known.size() - 1);
  constexpr double kChance = 6;  // what a lens model that is a little short makes of it
  if (chi2 < kChance * freedom) return 0;
  // DerSimonian and Laird's estimate of the variance between studies.
  double squares = 0;
  for (const OwnFocal& f : known) squares += 1 / std::pow(f.sigma, 4);
  return std::sqrt(std::max(0.0, (chi2 - freedom) / (weights - squares / weights)));
}

}  // namespace burin
