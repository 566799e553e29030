#include "burin/calib/geometry/lens_solver.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "burin/base/error.h"

namespace burin {
namespace {

constexpr std::array<const char*, 3> kLadder = {"LENSMODEL_OPENCV4", "LENSMODEL_OPENCV5", "LENSMODEL_OPENCV8"};

int rung(const std::string& model) {
  for (std::size_t i = 0; i < kLadder.size(); ++i)
    if (model == kLadder[i]) return static_cast<int>(i);
  return -1;
}

// A larger model of the family begins with the parameters of the smaller.
void climb(Lens& lens, int to) {
  lens.model = kLadder[to];
  lens.intrinsics.resize(lens_parameter_count(lens.model), 0.0);
}

}  // namespace

double information_criterion(const BundleSummary& s, const Bundle& b) {
  double n = 0, parameters = static_cast<double>(b.lens.intrinsics.size());
  for (const BundleCorner& c : b.corners) n += c.used ? 2 : 0;
  for (const ViewLens& lens : b.view_lenses) parameters += lens.moves() ? 3 : 0;
  return n * std::log(std::max(2 * s.cost, 1e-300) / n) + parameters * std::log(n);
}

BundleSummary solve_with_lens_model(Bundle& bundle, const BundleOptions& options, const std::string& model) {
  if (options.fix_lens) return solve_bundle(bundle, options);
  const int last = model.empty() ? static_cast<int>(kLadder.size()) - 1 : rung(model);
  if (last < 0) {
    // Another of mrcal's models needs its own initial guess.
    if (bundle.lens.model != model)
      fail("lens model \"" + model + "\"", "cannot be started from nothing",
           "give a .cameramodel of that model to start from, or use " + std::string(kLadder[0]) + ", " + kLadder[1] +
               " or " + kLadder[2]);
    return solve_bundle(bundle, options);
  }
  const int first = std::max(0, std::min(rung(bundle.lens.model), last));
  climb(bundle.lens, first);
  BundleSummary best = solve_bundle(bundle, options);
  for (int i = first + 1; i <= last; ++i) {
    Bundle next = bundle;
    climb(next.lens, i);
    const BundleSummary s = solve_bundle(next, options);
    if (!model.empty() || information_criterion(s, next) < information_criterion(best, bundle)) {
      bundle = std::move(next);
      best = s;
    }
  }
  return best;
}

LensSolution solve_lens(const std::vector<TargetView>& views, int width, int height, const Eigen::Vector2d& target_mm,
                        const LensSolverOptions& options) {
  const std::string where = "the photos of the target";
  if (views.size() < 3)
    fail(where, std::to_string(views.size()) + " do not determine a lens",
         "take at least three, better ten, tilted in different directions");
  Bundle bundle;
  bundle.lens = plain_lens(kLadder[0], width, width, height);
  bundle.surface.size_mm = target_mm;
  bundle.views.resize(views.size(), Eigen::Isometry3d::Identity());
  for (std::size_t v = 0; v < views.size(); ++v) {
    const TargetView& view = views[v];
    if (view.p_target_mm.size() != view.q_px.size() ||
        (!view.sigma_px.empty() && view.sigma_px.size() != view.q_px.size()))
      fail(view.name,
           "has " + std::to_string(view.p_target_mm.size()) + " points for " + std::to_string(view.q_px.size()) +
               " pixels",
           "give one pixel a point");
    if (view.q_px.size() < 4) fail(view.name, "shows fewer than four points", "leave it out");
    for (std::size_t i = 0; i < view.q_px.size(); ++i) {
      BundleCorner c;
      c.view = static_cast<int>(v);
      c.center_mm = view.p_target_mm[i];
      c.q_px = view.q_px[i];
      c.sigma_px = view.sigma_px.empty() ? 1 : view.sigma_px[i];
      bundle.corners.push_back(c);
    }
  }
  const double focal = seed_focal_px(bundle);
  bundle.lens = plain_lens(kLadder[0], focal, width, height);
  const PoseSeed seed = seed_poses(bundle, focal);
  for (std::size_t v = 0; v < views.size(); ++v) {
    if (!seed.found[v]) fail(views[v].name, "its points determine no pose", "leave it out");
    bundle.views[v] = seed.T_camera_board[v];
  }

  BundleOptions o;
  o.fix_tags = true;
  o.fix_bow = true;
  o.cauchy_sigma = options.cauchy_sigma;
  o.bow_prior_mm = 0.01 * target_mm.maxCoeff();
  solve_with_lens_model(bundle, o, kLadder[0]);
  o.fix_bow = !options.solve_bow;
  solve_with_lens_model(bundle, o, options.model);

  LensSolution out;
  const auto residuals = bundle_residuals_px(bundle);
  std::vector<double> view2(views.size(), 0);
  out.residual_px.resize(views.size());
  double sum2 = 0;
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    const BundleCorner& c = bundle.corners[i];
    const double e2 = residuals[i].squaredNorm() / (c.sigma_px * c.sigma_px);
    sum2 += e2;
    view2[c.view] += e2;
    out.residual_px[c.view].push_back(-residuals[i]);
  }
  out.rms_point_px = std::sqrt(sum2 / static_cast<double>(residuals.size()));
  out.rms_px = out.rms_point_px / std::sqrt(2.0);
  for (std::size_t v = 0; v < views.size(); ++v)
    out.view_rms_point_px.push_back(std::sqrt(view2[v] / static_cast<double>(views[v].q_px.size())));
  const BundleUncertainty uncertainty = bundle_uncertainty(bundle, o);
  out.covariance = out.rms_px * out.rms_px * uncertainty.lens;
  out.not_determined = uncertainty.not_determined;
  out.lens = bundle.lens;
  out.T_camera_target = bundle.views;
  out.bow_mm = bundle.surface.bow_mm;
  if (options.check_with_mrcal) out.check = check_with_mrcal(bundle);
  return out;
}

}  // namespace burin
