#include "burin/calib/light/probe/ball_outline.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "burin/base/median.h"
#include "burin/calib/light/probe/outline_edges.h"

namespace burin {
namespace {

constexpr std::array<double, 7> kReach = {0.08, 0.05, 0.03, 0.02, 0.02, 0.02, 0.02};  // of the radius, to each side
constexpr std::size_t kNearestFirst = 2;                                              // rounds of those
constexpr double kRoundReach = 0.05;                                                  // range for roundness
constexpr double kTrustWithin = 0.6;
constexpr double kEdgeSigma_px = 0.2;  // of an edge's place

// Distance of an edge's ray from the tangent cone, in sigmas. Parameters: x, y, z, radius.
struct OutlineResidual {
  Eigen::Vector3d eye, ray;
  double per_rad;

  template <typename T>
  bool operator()(const T* p, T* residual) const {
    const Eigen::Matrix<T, 3, 1> to(p[0] - eye.x(), p[1] - eye.y(), p[2] - eye.z());
    const T distance = to.norm();
    if (!(distance > p[3])) return false;
    const Eigen::Matrix<T, 3, 1> direction = ray.cast<T>();
    const T angle = ceres::atan2(to.cross(direction).norm(), to.dot(direction));
    residual[0] = per_rad * (angle - ceres::asin(p[3] / distance));
    return true;
  }
};

struct PriorResidual {
  double lift_sigma_mm;
  std::optional<double> radius_mm;

  template <typename T>
  bool operator()(const T* p, T* residual) const {
    residual[0] = (p[2] - p[3]) / lift_sigma_mm;
    residual[1] = radius_mm ? (p[3] - *radius_mm) / (1e-5 * *radius_mm) : T(0);
    return true;
  }
};

// One robust solve, with sigmas if requested.
bool solve_outline(std::span<const BallView> views, const std::vector<OutlineEdge>& edges, const BallPrior& prior,
                   FittedBall& fit, bool with_sigmas) {
  std::array<double, 4> p = {fit.ball.center_mm.x(), fit.ball.center_mm.y(), fit.ball.center_mm.z(),
                             fit.ball.radius_mm};
  ceres::Problem problem;
  for (const OutlineEdge& edge : edges) {
    const auto cone = tangent_cone(fit.ball, views[edge.view].eye_mm());
    // An edge inside may be a reflection of the outline's surroundings.
    const double trust = edge.off_px < 0 ? kTrustWithin : 1;
    problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<OutlineResidual, 1, 4>(new OutlineResidual{
            views[edge.view].eye_mm(), edge.ray,
            trust * pixels_per_rad(views[edge.view], *cone) / (kEdgeSigma_px * views[edge.view].scale)}),
        new ceres::CauchyLoss(1), p.data());
  }
  problem.AddResidualBlock(
      new ceres::AutoDiffCostFunction<PriorResidual, 2, 4>(new PriorResidual{prior.lift_sigma_mm, prior.radius_mm}),
      nullptr, p.data());
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  if (!summary.IsSolutionUsable() || !(p[3] > 0)) return false;
  fit.ball = {{p[0], p[1], p[2]}, p[3]};
  if (!with_sigmas) return true;
  ceres::Covariance::Options how;
  how.algorithm_type = ceres::DENSE_SVD;
  ceres::Covariance covariance(how);
  std::array<double, 16> matrix{};
  if (!covariance.Compute(std::vector<const double*>{p.data()}, &problem)) return false;
  covariance.GetCovarianceBlock(p.data(), p.data(), matrix.data());
  for (int i = 0; i < 3; ++i)
    fit.center_sigma_mm[i] = std::sqrt(std::max(0.0, matrix[static_cast<std::size_t>(5 * i)]));
  fit.radius_sigma_mm = std::sqrt(std::max(0.0, matrix[15]));
  return true;
}

// Amplitude of two and three waves around the outline in the edges' deviations, of the radius. Robust: weights by
// deviation.
double waves_around(const std::vector<OutlineEdge>& edges, double radius_px, double scale) {
  if (edges.size() < 12) return 0;
  Eigen::MatrixXd A(static_cast<Eigen::Index>(edges.size()), 7);
  Eigen::VectorXd b(A.rows()), weight = Eigen::VectorXd::Ones(A.rows());
  for (Eigen::Index i = 0; i < A.rows(); ++i) {
    const OutlineEdge& e = edges[static_cast<std::size_t>(i)];
    A.row(i) << 1, std::cos(e.turn), std::sin(e.turn), std::cos(2 * e.turn), std::sin(2 * e.turn), std::cos(3 * e.turn),
        std::sin(3 * e.turn);
    b[i] = e.off_px;
  }
  Eigen::VectorXd x = Eigen::VectorXd::Zero(7);
  for (int round = 0; round < 20; ++round) {
    // A weak prior at 0, for partly visible outlines.
    const Eigen::MatrixXd N = A.transpose() * weight.asDiagonal() * A +
                              0.01 * static_cast<double>(A.rows()) * Eigen::MatrixXd::Identity(7, 7);
    x = N.ldlt().solve(A.transpose() * weight.cwiseProduct(b));
    const Eigen::VectorXd left = b - A * x;
    weight = (1 + (left / (0.5 * scale)).array().square()).inverse();
  }
  return std::max(std::hypot(x[3], x[4]), std::hypot(x[5], x[6])) / radius_px;
}

OutlineLook look_of(const BallView& view, const MirrorBall& ball, const std::vector<OutlineEdge>& near,
                    const std::vector<OutlineEdge>& wide) {
  OutlineLook look;
  const auto cone = tangent_cone(ball, view.eye_mm());
  if (!cone) return look;
  look.radius_px = pixels_per_rad(view, *cone) * cone->half_angle;
  look.found = share_with_edge(view, ball);
  std::vector<double> off;
  for (const OutlineEdge& edge : near) off.push_back(std::abs(edge.off_px));
  look.rms_px = off.empty() ? 0 : 1.4826 * median_of(std::move(off));
  look.out_of_round = waves_around(wide, look.radius_px, view.scale);
  return look;
}

}  // namespace

std::optional<FittedBall> fit_ball(std::span<const BallView> views, const MirrorBall& guess, const BallPrior& prior) {
  constexpr std::size_t kFewest = 20;
  FittedBall fit;
  fit.ball = guess;
  std::vector<OutlineEdge> near;
  for (std::size_t round = 0; round < kReach.size(); ++round) {
    near = edges_about(views, fit.ball, kReach[round], round < kNearestFirst ? PickEdge::nearest : PickEdge::outermost);
    if (near.size() < kFewest || !solve_outline(views, near, prior, fit, round + 1 == kReach.size()))
      return std::nullopt;
  }
  near = edges_about(views, fit.ball, kReach.back(), PickEdge::outermost);
  const std::vector<OutlineEdge> wide = edges_about(views, fit.ball, kRoundReach, PickEdge::outermost);
  for (std::size_t v = 0; v < views.size(); ++v) {
    const auto of_view = [v](const std::vector<OutlineEdge>& edges) {
      std::vector<OutlineEdge> out;
      std::copy_if(edges.begin(), edges.end(), std::back_inserter(out),
                   [v](const OutlineEdge& edge) { return edge.view == static_cast<int>(v); });
      return out;
    };
    fit.views.push_back(look_of(views[v], fit.ball, of_view(near), of_view(wide)));
  }
  return fit;
}

}  // namespace burin
