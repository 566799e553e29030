#include "burin/calib/geometry/geometry_prior.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "burin/base/median.h"
#include "burin/calib/geometry/bundle.h"
#include "burin/calib/geometry/information.h"
#include "burin/scene/board_face.h"
#include "burin/scene/lens.h"
#include "burin/scene/parameter_name.h"

namespace burin {

namespace {

constexpr std::size_t kLensCore = 4;  // fx fy cx cy

// BundleUncertainty's pose parameters (added to the rotation vector; translation) by this module's (r, t).
Eigen::Matrix<double, 6, 6> bundle_pose_by_move(const Eigen::Isometry3d& T) {
  const auto cross = [](const Eigen::Vector3d& v) {
    return (Eigen::Matrix3d() << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0).finished();
  };
  const Eigen::AngleAxisd turn(T.linear());
  const double angle = turn.angle();
  const Eigen::Matrix3d K = cross(turn.axis());
  // Inverse of the left Jacobian of SO(3): 1 - angle/2 K + (1 - (angle/2) cot(angle/2)) K^2.
  const double half = 0.5 * angle;
  const double third = half > 1e-6 ? 1 - half / std::tan(half) : half * half / 3;
  Eigen::Matrix<double, 6, 6> out = Eigen::Matrix<double, 6, 6>::Identity();
  out.topLeftCorner<3, 3>() = Eigen::Matrix3d::Identity() - half * K + third * K * K;
  out.bottomLeftCorner<3, 3>() = -cross(T.translation());
  return out;
}

// Ratio of the cameras' sigmas in the bench to those from the tags' noise alone. The former include refocusing between
// photos, which no residual shows. 1 unless the ratio is large.
double beyond_noise(const Bundle& bundle, const BundleOptions& options, const std::vector<View>& views) {
  const BundleUncertainty u = bundle_uncertainty(bundle, options);
  std::vector<double> times;
  for (std::size_t v = 0; v < views.size(); ++v)
    if (const double noise_mm = std::sqrt(std::max(0.0, u.center_mm2[v].trace()));
        views[v].center_sigma_mm && noise_mm > 0)
      times.push_back(views[v].center_sigma_mm->norm() / noise_mm);
  constexpr double kMuch = 2;
  const double usual = median_of(std::move(times));
  return usual > kMuch ? usual : 1;
}

}  // namespace

namespace {

// A view's lens from the bench. A photo is a digital zoom if its lens differs by far more than the others'.
ViewLens view_lens_of(const View& view, const LensScatter& scatter) {
  const OwnLens own = view.own_lens.value_or(OwnLens{});
  return {
      own,
      {std::max(scatter.shift_px, own.shift_px.norm()), std::max(scatter.focal, std::abs(std::log(own.focal_ratio)))}};
}

// A bundle with the tags' corners at their predicted positions: the prior needs only their information.
Bundle predicted_bundle(const Board& board, const Bench& bench) {
  Bundle bundle;
  bundle.lens = bench.lens;
  bundle.surface = surface_of(board, bench);
  const std::vector<Tag>& tags = bench.tags.empty() ? board.tags.list : bench.tags;
  for (const Tag& tag : tags) {
    TagPlacement placement;
    placement.sigma_mm = std::max(board.tags.sigma_mm, 1e-4);
    placement.sigma_rad = placement.sigma_mm / (tag.size_mm / 2);
    bundle.tags.push_back(placement);
  }
  for (const View& view : bench.views) {
    bundle.views.push_back(view.T_camera_board);
    if (bench.lens_scatter) bundle.view_lenses.push_back(view_lens_of(view, *bench.lens_scatter));
  }
  for (std::size_t v = 0; v < bench.views.size(); ++v) {
    const View& view = bench.views[v];
    if (!view.reprojection_rms_px || !(*view.reprojection_rms_px > 0)) continue;
    const double seen = view.tags ? static_cast<double>(*view.tags) / static_cast<double>(tags.size()) : 1;
    if (!(seen > 0)) continue;
    const double sigma_px = *view.reprojection_rms_px / std::sqrt(std::min(1.0, seen));
    for (std::size_t t = 0; t < tags.size(); ++t) {
      const auto corners = corners_to_see(bundle, v, t, tags[t], board.tags.z_mm, sigma_px);
      bundle.corners.insert(bundle.corners.end(), corners.begin(), corners.end());
    }
  }
  return bundle;
}

constexpr double kExact = 1e18;

// The information of all views' own columns, followed by the shared columns. `own`: columns per view.
Eigen::MatrixXd whole_information(const BundleEquations& equations, const Bench& bench, Eigen::Index own) {
  const auto views = static_cast<Eigen::Index>(bench.views.size());
  const Eigen::Index columns = equations.columns;
  Eigen::MatrixXd shared = equations.prior;
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(own * views + columns, own * views + columns);
  for (Eigen::Index v = 0; v < views; ++v) {
    const BundleEquations::OfView& view = equations.views[v];
    if (!view.used) {
      H.diagonal().segment(own * v, own).setConstant(kExact);
      continue;
    }
    shared += view.information + view.B.transpose() * view.H.ldlt().solve(view.B);
    Eigen::MatrixXd by_move = Eigen::MatrixXd::Identity(own, own);
    by_move.topLeftCorner<6, 6>() = bundle_pose_by_move(bench.views[v].T_camera_board);
    for (Eigen::Index i = 6; i + 1 < own; ++i) by_move(i, i) = bench.lens.intrinsics[i - 6];  // shifts; a logarithm
    H.block(own * v, own * v, own, own) = by_move.transpose() * view.H * by_move;
    H.block(own * v, own * views, own, columns) = by_move.transpose() * view.B;
  }
  H.bottomRightCorner(columns, columns) = shared;
  H.bottomLeftCorner(columns, own * views) = H.topRightCorner(own * views, columns).transpose();
  return H;
}

}  // namespace

GeometryPrior geometry_prior(const Board& board, const Bench& bench, bool own_lenses_move) {
  GeometryPrior prior;
  for (const View& view : bench.views) prior.T_camera_board.push_back(view.T_camera_board);
  Bundle bundle = predicted_bundle(board, bench);
  const auto views = static_cast<Eigen::Index>(bench.views.size());
  BundleOptions options;
  const Verdict* lens_verdict = find_verdict(bench, parameter::kLens);
  options.fix_lens = lens_verdict != nullptr && lens_verdict->source == Source::given;
  const auto movable = static_cast<Eigen::Index>(free_lens_parameters(bench.lens));
  const Eigen::Index lens = options.fix_lens ? 0 : movable, own = bench.lens_scatter ? 9 : 6;
  prior.of_view = own_lenses_move && movable > 0 ? own : 6;
  const Eigen::Index kept = prior.of_view * views + 3 + lens;
  prior.lens_parameters = lens;
  prior.moved = Eigen::VectorXd::Zero(kept);
  prior.information = Eigen::MatrixXd::Zero(kept, kept);
  if (bundle.corners.empty()) {
    prior.information.diagonal().setConstant(kExact);
    return prior;
  }

  if (const double times = beyond_noise(bundle, options, bench.views); times > 1)
    for (BundleCorner& corner : bundle.corners) corner.sigma_px *= times;

  const BundleEquations equations = bundle_equations(bundle, options);
  // Kept columns first: those of each view, the bow, the lens.
  const Eigen::Index shared = own * views, bow = shared + equations.shared_at + 1;
  std::vector<Eigen::Index> order;
  for (Eigen::Index v = 0; v < views; ++v)
    for (Eigen::Index i = 0; i < prior.of_view; ++i) order.push_back(own * v + i);
  for (Eigen::Index i = 0; i < 3; ++i) order.push_back(bow + i);
  for (Eigen::Index i = 0; i < lens; ++i) order.push_back(shared + equations.lens_at + i);
  std::vector<bool> in_front(static_cast<std::size_t>(shared + equations.columns), false);
  for (const Eigen::Index i : order) in_front[static_cast<std::size_t>(i)] = true;
  for (std::size_t i = 0; i < in_front.size(); ++i)
    if (!in_front[i]) order.push_back(static_cast<Eigen::Index>(i));
  const Eigen::MatrixXd H = whole_information(equations, bench, own)(order, order);

  const Eigen::Index rest = H.rows() - kept;
  const Eigen::MatrixXd across = H.topRightCorner(kept, rest);
  prior.information =
      H.topLeftCorner(kept, kept) - across * inverse_times(H.bottomRightCorner(rest, rest), across.transpose());
  prior.information = 0.5 * (prior.information + prior.information.transpose()).eval();
  // The lens in the units of moved_lens().
  for (Eigen::Index i = 0; i < lens; ++i) {
    const double unit = lens_unit(bench.lens, i);
    prior.information.row(kept - lens + i) *= unit;
    prior.information.col(kept - lens + i) *= unit;
  }
  return prior;
}

OwnLens moved_own_lens(const OwnLens& own, const Lens& lens, const Eigen::Vector3d& by) {
  return {own.shift_px + Eigen::Vector2d(by.x() * lens.intrinsics[0], by.y() * lens.intrinsics[1]),
          own.focal_ratio * std::exp(by.z())};
}

std::size_t free_lens_parameters(const Lens& lens) {
  const std::size_t parameters = lens.intrinsics.size();
  return parameters >= kLensCore && parameters <= kMostLensParameters ? parameters : 0;
}

double lens_unit(const Lens& lens, std::size_t i) { return i < kLensCore ? lens.intrinsics[i % 2] : 1; }

Lens moved_lens(const Lens& lens, const Eigen::VectorXd& by) {
  Lens moved = lens;
  for (Eigen::Index i = 0; i < by.size(); ++i) moved.intrinsics[i] += by[i] * lens_unit(lens, i);
  return moved;
}

Vector6 pose_difference(const Eigen::Isometry3d& from, const Eigen::Isometry3d& to) {
  const Eigen::AngleAxisd turn(Eigen::Matrix3d(to.linear() * from.linear().transpose()));
  Vector6 by;
  by << turn.angle() * turn.axis(), to.translation() - turn * from.translation();
  return by;
}

Eigen::Isometry3d moved_pose(const Eigen::Isometry3d& T_camera_board, const Vector6& by) {
  const Eigen::Vector3d r = by.head<3>();
  Eigen::Isometry3d moved = T_camera_board;
  if (r.norm() > 0) moved = Eigen::AngleAxisd(r.norm(), r.normalized()) * moved;
  moved.translation() += by.tail<3>();
  return moved;
}

}  // namespace burin
