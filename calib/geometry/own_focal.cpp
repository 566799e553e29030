#include "burin/calib/geometry/own_focal.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>

namespace burin {
namespace {

// Rotation, translation; logarithm of the focal length, shift of the principal point.
constexpr int kFreePose = 6, kWithFocal = 7, kWithCenter = 9;

struct OwnCorners {
  std::vector<Eigen::Vector3d> p_mm;  // on the board
  std::vector<Eigen::Vector2d> q_px;
  std::vector<double> sigma_px;
};

// A view's pose and lens during the fit.
struct FreeView {
  Eigen::Isometry3d T_camera_board;
  Eigen::Vector3d own{0, 0, 0};  // logarithm of the focal length, shift
};

Eigen::VectorXd residuals_at(const OwnCorners& corners, const Lens& lens, const FreeView& at) {
  const Lens own = with_own(lens, {at.own.tail<2>(), std::exp(at.own[0])});
  std::vector<Eigen::Vector3d> v;
  for (const Eigen::Vector3d& p : corners.p_mm) v.emplace_back(at.T_camera_board * p);
  std::vector<Eigen::Vector2d> q(v.size());
  project(own, v, q);
  Eigen::VectorXd r(2 * static_cast<Eigen::Index>(q.size()));
  for (std::size_t i = 0; i < q.size(); ++i)
    r.segment<2>(2 * static_cast<Eigen::Index>(i)) = (q[i] - corners.q_px[i]) / corners.sigma_px[i];
  return r;
}

FreeView moved(const FreeView& from, const Eigen::VectorXd& x) {
  FreeView out = from;
  const Eigen::Vector3d turn = x.head<3>();
  if (turn.norm() > 0)
    out.T_camera_board.linear() =
        Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix() * from.T_camera_board.linear();
  out.T_camera_board.translation() += x.segment<3>(3);
  out.own.head(x.size() - kFreePose) += x.tail(x.size() - kFreePose);
  return out;
}

// `numbers`: kWithFocal or kWithCenter.
std::optional<OwnLensFit> own_lens_fit(const OwnCorners& corners, const Lens& lens, const Eigen::Isometry3d& T,
                                       Eigen::Index numbers) {
  constexpr std::size_t kFewestCorners = 12;
  if (corners.p_mm.size() < kFewestCorners) return std::nullopt;
  Eigen::VectorXd step = Eigen::VectorXd::Constant(numbers, 1e-5);
  step.segment<3>(3) *= (T * corners.p_mm.front()).norm();
  step.tail(numbers - kWithFocal) *= lens.intrinsics[0];
  FreeView at{T};
  constexpr int kRounds = 8;
  Eigen::MatrixXd H;
  double chi2 = 0;
  for (int round = 0; round <= kRounds; ++round) {
    const Eigen::VectorXd r = residuals_at(corners, lens, at);
    if (!r.allFinite()) return std::nullopt;
    Eigen::MatrixXd J(r.size(), numbers);
    for (Eigen::Index k = 0; k < numbers; ++k)
      J.col(k) = (residuals_at(corners, lens, moved(at, step[k] * Eigen::VectorXd::Unit(numbers, k))) - r) / step[k];
    if (!J.allFinite()) return std::nullopt;
    // Outliers of the view itself get Cauchy weights.
    constexpr double kRobust = 3;
    Eigen::VectorXd weight = (1 + r.array().square() / (kRobust * kRobust)).inverse().matrix();
    if (round == 0) weight.setOnes();
    H = J.transpose() * weight.asDiagonal() * J;
    chi2 = (weight.array() * r.array().square()).sum() / std::max(1.0, weight.sum() - static_cast<double>(numbers));
    if (round == kRounds) break;
    Eigen::VectorXd x = -H.ldlt().solve(J.transpose() * weight.asDiagonal() * r);
    if (!x.allFinite()) return std::nullopt;
    constexpr double kLongest = 0.3;
    if (std::abs(x[kFreePose]) > kLongest) x *= kLongest / std::abs(x[kFreePose]);
    at = moved(at, x);
  }
  // The corners' sigmas include the misfit of the common lens. With its own lens a view fits far better, if lenses
  // differ.
  constexpr double kLeast = 1e-4;
  const double scale = numbers == kWithCenter ? std::max(chi2, kLeast) : std::max(chi2, 1.0);
  const Eigen::MatrixXd covariance = H.ldlt().solve(Eigen::MatrixXd::Identity(numbers, numbers)) * scale;
  OwnLensFit out;
  for (Eigen::Index i = kFreePose; i < numbers; ++i) {
    const Eigen::Index to = i == kFreePose ? 2 : i - kWithFocal;
    if (!(covariance(i, i) > 0)) return std::nullopt;
    out.difference[to] = at.own[i - kFreePose];
    out.covariance(to, to) = covariance(i, i);
  }
  return out;
}

std::vector<std::optional<OwnLensFit>> fits_of_views(const Bundle& bundle, Eigen::Index numbers) {
  std::vector<OwnCorners> of_view(bundle.views.size());
  for (const BundleCorner& corner : bundle.corners) {
    OwnCorners& own = of_view[static_cast<std::size_t>(corner.view)];
    own.p_mm.push_back(bundle_point_mm(bundle, corner));
    own.q_px.push_back(corner.q_px - bundle.spread_px * corner.outward);
    own.sigma_px.push_back(corner.sigma_px);
  }
  std::vector<std::optional<OwnLensFit>> out;
  for (std::size_t v = 0; v < of_view.size(); ++v)
    out.push_back(own_lens_fit(of_view[v], lens_of(bundle, v), bundle.views[v], numbers));
  return out;
}

// One number of a view, and its sigma.
struct Known {
  double value, sigma;
};

// DerSimonian and Laird's estimate of the variance between studies, as a standard deviation; 0 if chance explains it.
double scatter_between(const std::vector<Known>& known) {
  constexpr std::size_t kFewest = 4;
  if (known.size() < kFewest) return 0;
  double weights = 0, mean = 0;
  for (const Known& f : known) weights += 1 / (f.sigma * f.sigma), mean += f.value / (f.sigma * f.sigma);
  mean /= weights;
  double chi2 = 0;
  for (const Known& f : known) chi2 += (f.value - mean) * (f.value - mean) / (f.sigma * f.sigma);
  const auto freedom = static_cast<double>(known.size() - 1);
  constexpr double kChance = 6;  // margin for a slightly insufficient lens model
  if (chi2 < kChance * freedom) return 0;
  double squares = 0;
  for (const Known& f : known) squares += 1 / std::pow(f.sigma, 4);
  return std::sqrt(std::max(0.0, (chi2 - freedom) / (weights - squares / weights)));
}

constexpr double kUseful = 0.05;  // views with a larger sigma of the logarithm give no information

}  // namespace

std::vector<std::optional<OwnFocal>> own_focals(const Bundle& bundle) {
  std::vector<std::optional<OwnFocal>> out;
  for (const std::optional<OwnLensFit>& fit : fits_of_views(bundle, kWithFocal))
    out.push_back(fit ? std::optional(OwnFocal{fit->difference[2], std::sqrt(fit->covariance(2, 2))}) : std::nullopt);
  return out;
}

std::vector<std::optional<OwnLensFit>> own_lens_fits(const Bundle& bundle) {
  return fits_of_views(bundle, kWithCenter);
}

LensScatter lens_scatter(const std::vector<std::optional<OwnLensFit>>& fits, const std::vector<bool>& counts) {
  std::array<std::vector<Known>, 3> known;
  for (std::size_t v = 0; v < fits.size(); ++v) {
    if (!counts[v] || !fits[v] || !(std::sqrt(fits[v]->covariance(2, 2)) < kUseful)) continue;
    for (Eigen::Index i = 0; i < 3; ++i)
      known[static_cast<std::size_t>(i)].push_back({fits[v]->difference[i], std::sqrt(fits[v]->covariance(i, i))});
  }
  return {std::max(scatter_between(known[0]), scatter_between(known[1])), scatter_between(known[2])};
}

double focal_scatter(const std::vector<std::optional<OwnFocal>>& focals, const std::vector<bool>& counts) {
  std::vector<Known> known;
  for (std::size_t v = 0; v < focals.size(); ++v)
    if (counts[v] && focals[v] && focals[v]->sigma < kUseful) known.push_back({focals[v]->log_ratio, focals[v]->sigma});
  return scatter_between(known);
}

}  // namespace burin
