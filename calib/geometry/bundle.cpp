#include "burin/calib/geometry/bundle.h"

#include <ceres/ceres.h>
extern "C" {  // mrcal's headers do not support C++ themselves
#include <mrcal/mrcal.h>
#include <mrcal/poseutils.h>
}

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <optional>
#include <span>

#include "burin/base/error.h"
#include "burin/base/median.h"
#include "burin/calib/geometry/information.h"

namespace burin {
namespace {

using Pose = std::array<double, 6>;  // rotation vector, translation: R p + t
using Matrix6 = Eigen::Matrix<double, 6, 6>;

mrcal_lensmodel_t model_of(const Lens& lens) {
  mrcal_lensmodel_t model;
  if (!mrcal_lensmodel_from_name(&model, lens.model.c_str()) ||
      mrcal_lensmodel_num_params(&model) != static_cast<int>(lens.intrinsics.size()))
    fail("lens", lens.model + " with " + std::to_string(lens.intrinsics.size()) + " parameters is no lens of mrcal's",
         "use LENSMODEL_OPENCV4, 5 or 8");
  return model;
}

Pose to_pose(const Eigen::Isometry3d& T) {
  const Eigen::AngleAxisd a(T.rotation());
  const Eigen::Vector3d r = a.angle() * a.axis();
  return {r.x(), r.y(), r.z(), T.translation().x(), T.translation().y(), T.translation().z()};
}

Eigen::Isometry3d to_isometry(const double* p) {
  Eigen::Matrix<double, 3, 3, Eigen::RowMajor> R;
  mrcal_R_from_r(R.data(), nullptr, p);
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = R;
  T.translation() = Eigen::Vector3d(p[3], p[4], p[5]);
  return T;
}

// Position of a point on a bent sheet, z_mm above its face, and its derivatives along the sheet and by the bow.
Eigen::Vector3d bent_point(const Surface& believed, const Eigen::Vector3d& bow_mm, const Eigen::Vector2d& xy,
                           double z_mm, Eigen::Matrix<double, 3, 2>* by_xy, Eigen::Matrix3d* by_bow) {
  const Cylinder sheet = cylinder_of(Surface{believed.size_mm, bow_mm, believed.bend});
  const BentPlace place = bent_place(sheet, xy);
  if (by_xy)
    *by_xy =
        (1 + z_mm * sheet.curvature) * place.across * sheet.across.transpose() + place.along * sheet.along.transpose();
  if (by_bow) {
    const BentMotion moves = bent_motion(sheet, xy);
    by_bow->setZero();
    for (int i = 0; i < 2; ++i) by_bow->col(i) = moves.position_by[i] + z_mm * moves.normal_by[i];
  }
  return place.position_mm + z_mm * place.normal;
}

// Edge, bow and spread.
constexpr int kShared = 5;

// The corner on the board and its derivatives by the shared block's edge and bow, and by its tag's placement.
Eigen::Vector3d board_point(const BundleCorner& c, const Surface& surface, const double* shared,
                            const double* placement, Eigen::Matrix<double, 3, 4>* by_shared,
                            Eigen::Matrix3d* by_placement) {
  const Eigen::Vector2d& size_mm = surface.size_mm;
  const double turn = placement ? placement[2] : 0, cs = std::cos(turn), sn = std::sin(turn);
  // The edge moves both sides at the corner outwards: along the diagonal, sqrt(2) edge.
  const double half = c.offset_mm.norm() / std::sqrt(2.0), grow = half > 0 ? 1 + shared[0] / half : 1;
  const Eigen::Vector2d turned(cs * c.offset_mm.x() - sn * c.offset_mm.y(),
                               sn * c.offset_mm.x() + cs * c.offset_mm.y());
  Eigen::Vector2d xy = c.center_mm + grow * turned;
  if (placement) xy += Eigen::Vector2d(placement[0], placement[1]);
  if (surface.bend) {
    Eigen::Matrix<double, 3, 2> by_xy;
    Eigen::Matrix3d by_bow;
    Eigen::Vector3d p = bent_point(surface, {shared[1], shared[2], shared[3]}, xy, c.z_mm, &by_xy, &by_bow);
    if (by_shared) {
      by_shared->col(0) = half > 0 ? Eigen::Vector3d(by_xy * turned / half) : Eigen::Vector3d::Zero();
      by_shared->rightCols<3>() = by_bow;
    }
    if (by_placement) {
      by_placement->leftCols<2>() = by_xy;
      by_placement->col(2) = by_xy * (grow * Eigen::Vector2d(-turned.y(), turned.x()));
    }
    return p;
  }
  const double X = 2 * xy.x() / size_mm.x() - 1, Y = 2 * xy.y() / size_mm.y() - 1;
  const double z = c.z_mm + shared[1] * X * X + shared[2] * X * Y + shared[3] * Y * Y;
  if (by_shared || by_placement) {
    const Eigen::RowVector2d dz_dxy((2 * shared[1] * X + shared[2] * Y) * 2 / size_mm.x(),
                                    (shared[2] * X + 2 * shared[3] * Y) * 2 / size_mm.y());
    auto lift = [&dz_dxy](const Eigen::Vector2d& dxy) { return Eigen::Vector3d(dxy.x(), dxy.y(), dz_dxy.dot(dxy)); };
    if (by_shared) {
      by_shared->col(0) = half > 0 ? lift(turned / half) : Eigen::Vector3d::Zero();
      by_shared->rightCols<3>().setZero();
      by_shared->block<1, 3>(2, 1) << X * X, X * Y, Y * Y;
    }
    if (by_placement) {
      by_placement->col(0) = lift({1, 0});
      by_placement->col(1) = lift({0, 1});
      by_placement->col(2) = lift(grow * Eigen::Vector2d(-turned.y(), turned.x()));
    }
  }
  return {xy.x(), xy.y(), z};
}

// A view's own parameters: its pose, then the shift of its principal point (px) and the logarithm of its focal length
// over the common one.
constexpr int kPose = 6, kOwn = 9;

// Blocks: lens, the view's own, shared, and the tag's placement if it has one. A view without its own lens has the
// bundle's.
class ReprojectionCost final : public ceres::CostFunction {
 public:
  ReprojectionCost(const mrcal_lensmodel_t& model, int lens_parameters, const Surface& surface,
                   const BundleCorner& corner, const ViewLens& view_lens)
      : model_(model),
        lens_parameters_(lens_parameters),
        surface_(surface),
        corner_(corner),
        view_lens_(view_lens),
        own_(view_lens.moves() ? kOwn : kPose) {
    set_num_residuals(2);
    *mutable_parameter_block_sizes() = {lens_parameters, own_, kShared};
    if (corner.tag >= 0) mutable_parameter_block_sizes()->push_back(3);
  }

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    const double* placement = corner_.tag >= 0 ? parameters[3] : nullptr;
    Eigen::Matrix<double, 3, 4> p_by_shared;
    Eigen::Matrix3d p_by_placement;
    const Eigen::Vector3d p =
        board_point(corner_, surface_, parameters[2], placement, jacobians ? &p_by_shared : nullptr,
                    jacobians && placement ? &p_by_placement : nullptr);
    Eigen::Vector3d v;
    Eigen::Matrix<double, 3, 6, Eigen::RowMajor> v_by_pose;
    Eigen::Matrix<double, 3, 3, Eigen::RowMajor> v_by_p;
    mrcal_transform_point_rt(v.data(), jacobians ? v_by_pose.data() : nullptr, jacobians ? v_by_p.data() : nullptr,
                             parameters[1], p.data());
    if (!(v.z() > 0)) return false;
    mrcal_point2_t q;
    mrcal_point3_t q_by_v[2], point = {{v.x(), v.y(), v.z()}};
    const double weight = 1 / corner_.sigma_px;
    std::vector<double> q_by_lens;
    const bool lens_too = jacobians && (jacobians[0] || own_ == kOwn);
    if (lens_too) q_by_lens.resize(static_cast<std::size_t>(2) * lens_parameters_);
    const double* const own = parameters[1] + kPose;
    const Eigen::Vector2d shift = own_ == kOwn ? Eigen::Vector2d(own[0], own[1]) : view_lens_.own.shift_px;
    const double ratio = own_ == kOwn ? std::exp(own[2]) : view_lens_.own.focal_ratio;
    std::vector<double> lens(parameters[0], parameters[0] + lens_parameters_);
    for (std::size_t i = 0; i < 2 && lens.size() >= 4; ++i) {
      lens[i] *= ratio;
      lens[2 + i] += shift[static_cast<Eigen::Index>(i)];
    }
    if (!mrcal_project(&q, jacobians ? q_by_v : nullptr, lens_too ? q_by_lens.data() : nullptr, &point, 1, &model_,
                       lens.data()))
      return false;
    const double spread = parameters[2][kShared - 1];
    residuals[0] = weight * (q.x + spread * corner_.outward.x() - corner_.q_px.x());
    residuals[1] = weight * (q.y + spread * corner_.outward.y() - corner_.q_px.y());
    if (!std::isfinite(residuals[0]) || !std::isfinite(residuals[1])) return false;
    if (!jacobians) return true;
    using RowMajor = Eigen::Matrix<double, 2, Eigen::Dynamic, Eigen::RowMajor>;
    Eigen::Matrix<double, 2, 3> D;
    D << q_by_v[0].x, q_by_v[0].y, q_by_v[0].z, q_by_v[1].x, q_by_v[1].y, q_by_v[1].z;
    D *= weight;
    if (jacobians[1]) Eigen::Map<RowMajor>(jacobians[1], 2, own_).leftCols(kPose) = D * v_by_pose;
    if (jacobians[1] && own_ == kOwn) {
      const Eigen::Map<RowMajor> by_lens(q_by_lens.data(), 2, lens_parameters_);
      Eigen::Map<RowMajor> by_own(jacobians[1], 2, own_);
      by_own.middleCols(kPose, 2) = weight * by_lens.middleCols(2, 2);
      by_own.rightCols(1) = weight * (lens[0] * by_lens.col(0) + lens[1] * by_lens.col(1));
    }
    if (jacobians[0]) {
      Eigen::Map<RowMajor> by_lens(jacobians[0], 2, lens_parameters_);
      by_lens = weight * Eigen::Map<RowMajor>(q_by_lens.data(), 2, lens_parameters_);
      by_lens.leftCols(2) *= ratio;
    }
    if (jacobians[2]) {
      Eigen::Map<RowMajor> by_shared(jacobians[2], 2, kShared);
      by_shared << D * v_by_p * p_by_shared, weight * corner_.outward;
    }
    if (placement && jacobians[3]) Eigen::Map<RowMajor>(jacobians[3], 2, 3) = D * v_by_p * p_by_placement;
    return true;
  }

 private:
  mrcal_lensmodel_t model_;
  int lens_parameters_;
  Surface surface_;
  BundleCorner corner_;
  ViewLens view_lens_;
  int own_;
};

// Prior of a view's lens difference.
class ViewLensPrior final : public ceres::CostFunction {
 public:
  explicit ViewLensPrior(const LensScatter& prior) : weight_{1 / prior.shift_px, 1 / prior.shift_px, 1 / prior.focal} {
    set_num_residuals(3);
    *mutable_parameter_block_sizes() = {kOwn};
  }
  bool Evaluate(double const* const* x, double* residuals, double** jacobians) const override {
    for (int i = 0; i < 3; ++i) residuals[i] = weight_[i] * x[0][kPose + i];
    if (jacobians && jacobians[0]) {
      std::fill(jacobians[0], jacobians[0] + 3 * kOwn, 0.0);
      for (int i = 0; i < 3; ++i) jacobians[0][i * kOwn + kPose + i] = weight_[i];
    }
    return true;
  }

 private:
  std::array<double, 3> weight_;
};

ViewLens view_lens(const Bundle& b, std::size_t view) {
  return view < b.view_lenses.size() ? b.view_lenses[view] : ViewLens{};
}

std::vector<double> shared_prior_sigma(const BundleOptions& o) {
  return {o.edge_prior_mm, o.bow_prior_mm, o.bow_prior_mm, o.bow_prior_mm, o.spread_prior_px};
}

// Residuals (x - mean) / sigma for one block.
class DiagonalPrior final : public ceres::CostFunction {
 public:
  DiagonalPrior(std::vector<double> mean, std::vector<double> sigma)
      : mean_(std::move(mean)), sigma_(std::move(sigma)) {
    set_num_residuals(static_cast<int>(mean_.size()));
    *mutable_parameter_block_sizes() = {static_cast<int>(mean_.size())};
  }
  bool Evaluate(double const* const* x, double* residuals, double** jacobians) const override {
    const std::size_t n = mean_.size();
    for (std::size_t i = 0; i < n; ++i) residuals[i] = (x[0][i] - mean_[i]) / sigma_[i];
    if (jacobians && jacobians[0]) {
      std::fill(jacobians[0], jacobians[0] + n * n, 0.0);
      for (std::size_t i = 0; i < n; ++i) jacobians[0][i * n + i] = 1 / sigma_[i];
    }
    return true;
  }

 private:
  std::vector<double> mean_, sigma_;
};

// Gauge of the set of tags: sums of shifts, of moments and of radial parts are zero.
constexpr double kHold_mm = 1e-4;
class TagSetHeld final : public ceres::CostFunction {
 public:
  explicit TagSetHeld(const std::vector<Eigen::Vector2d>& centers_mm) {
    set_num_residuals(4);
    mutable_parameter_block_sizes()->assign(centers_mm.size(), 3);
    Eigen::Vector2d mean(0, 0);
    for (const auto& c : centers_mm) mean += c / static_cast<double>(centers_mm.size());
    double moment = 0;
    for (const auto& c : centers_mm) moment += (c - mean).squaredNorm();
    const double n = static_cast<double>(centers_mm.size());
    for (const auto& c : centers_mm) {
      const Eigen::Vector2d r = (c - mean) / std::sqrt(std::max(moment * n, 1e-12));  // rms radius times angle, per tag
      Eigen::Matrix<double, 4, 3, Eigen::RowMajor> J;
      J << 1 / n, 0, 0, 0, 1 / n, 0, -r.y(), r.x(), 0, r.x(), r.y(), 0;
      rows_.push_back(J / kHold_mm);
    }
  }
  bool Evaluate(double const* const* x, double* residuals, double** jacobians) const override {
    Eigen::Map<Eigen::Vector4d> r(residuals);
    r.setZero();
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      r += rows_[i] * Eigen::Map<const Eigen::Vector3d>(x[i]);
      if (jacobians && jacobians[i]) std::copy(rows_[i].data(), rows_[i].data() + 12, jacobians[i]);
    }
    return true;
  }

 private:
  std::vector<Eigen::Matrix<double, 4, 3, Eigen::RowMajor>> rows_;
};

// Wide priors about the plainest lens of the same focal length. OPENCV8's numerator and denominator almost cancel for a
// narrow lens; the priors keep them from diverging together. mrcal regularizes for the same reason.
std::vector<double> lens_prior_sigma(const Lens& lens) {
  std::vector<double> sigma(lens.intrinsics.size(), 1.0);
  const double size = std::max(lens.width, lens.height);
  const bool rational = sigma.size() > 9;
  sigma[0] = sigma[1] = 10 * size;
  sigma[2] = sigma[3] = size;
  for (std::size_t i = 4; i < sigma.size(); ++i) sigma[i] = i == 6 || i == 7 ? 1.0 : (rational ? 3.0 : 100.0);
  return sigma;
}

// A focal length or a center with a larger sigma is not calibrated, however wide its prior is.
constexpr double kFocalKnown = 0.02;   // of the focal length
constexpr double kCenterKnown = 0.05;  // of the picture's longer side

bool has_core_and_few(const Lens& lens) { return lens.intrinsics.size() >= 4 && lens.intrinsics.size() <= 16; }

// Parameters as Ceres sees them, and the problem around them.
struct Work {
  // One array holds all, because Ceres orders blocks by address, and sums must always have one order.
  std::vector<double> all;
  std::span<double> lens, shared;
  std::vector<double*> poses, placements;
  std::vector<int> view_corners;  // used corners per view
  std::vector<bool> tag_seen;
  std::unique_ptr<ceres::Problem> problem;

  explicit Work(const Bundle& b) : view_corners(b.views.size()), tag_seen(b.tags.size()) {
    const std::size_t n_lens = b.lens.intrinsics.size();
    all.resize(kOwn * b.views.size() + n_lens + kShared + 3 * b.tags.size());
    double* at = all.data();
    for (std::size_t v = 0; v < b.views.size(); ++v) {
      const Pose pose = to_pose(b.views[v]);
      std::copy(pose.begin(), pose.end(), at);
      const OwnLens own = view_lens(b, v).own;
      at[kPose] = own.shift_px.x();
      at[kPose + 1] = own.shift_px.y();
      at[kPose + 2] = std::log(own.focal_ratio);
      poses.push_back(at);
      at += kOwn;
    }
    lens = {at, n_lens};
    std::copy(b.lens.intrinsics.begin(), b.lens.intrinsics.end(), at);
    at += n_lens;
    shared = {at, kShared};
    shared[0] = b.edge_mm;
    for (int i = 0; i < 3; ++i) shared[1 + i] = b.surface.bow_mm[i];
    shared[kShared - 1] = b.spread_px;
    at += kShared;
    for (const auto& t : b.tags) {
      at[0] = t.shift_mm.x();
      at[1] = t.shift_mm.y();
      at[2] = t.turn_rad;
      placements.push_back(at);
      at += 3;
    }
  }
  Work(const Work&) = delete;
  Work& operator=(const Work&) = delete;

  void build(const Bundle& b, const BundleOptions& o) {
    problem = std::make_unique<ceres::Problem>();
    const mrcal_lensmodel_t model = model_of(b.lens);
    std::vector<Eigen::Vector2d> centers(b.tags.size());
    for (const BundleCorner& c : b.corners) {
      if (!c.used) continue;
      std::vector<double*> blocks = {lens.data(), poses[c.view], shared.data()};
      if (c.tag >= 0) {
        blocks.push_back(placements[c.tag]);
        tag_seen[c.tag] = true;
        centers[c.tag] = c.center_mm;
      }
      ceres::LossFunction* loss = o.cauchy_sigma > 0 ? new ceres::CauchyLoss(o.cauchy_sigma) : nullptr;
      problem->AddResidualBlock(new ReprojectionCost(model, static_cast<int>(lens.size()), b.surface, c,
                                                     view_lens(b, static_cast<std::size_t>(c.view))),
                                loss, blocks);
      ++view_corners[c.view];
    }
    if (problem->NumResidualBlocks() == 0) return;
    if (o.fix_lens) {
      problem->SetParameterBlockConstant(lens.data());
    } else if (has_core_and_few(b.lens)) {
      std::vector<double> mean(lens.size(), 0.0);
      const double f = 0.5 * (lens[0] + lens[1]);
      mean[0] = mean[1] = f;
      mean[2] = (b.lens.width - 1) / 2.0;
      mean[3] = (b.lens.height - 1) / 2.0;
      problem->AddResidualBlock(new DiagonalPrior(mean, lens_prior_sigma(b.lens)), nullptr, lens.data());
    }
    const bool with_tags = std::any_of(tag_seen.begin(), tag_seen.end(), [](bool s) { return s; });
    if (o.fix_bow && (o.fix_tags || !with_tags)) {
      problem->SetParameterBlockConstant(shared.data());
    } else {
      if (o.fix_bow)
        problem->SetManifold(shared.data(), new ceres::SubsetManifold(kShared, {1, 2, 3}));
      else if (o.fix_tags || !with_tags)
        problem->SetManifold(shared.data(), new ceres::SubsetManifold(kShared, {0, kShared - 1}));
      problem->AddResidualBlock(new DiagonalPrior(std::vector<double>(kShared, 0.0), shared_prior_sigma(o)), nullptr,
                                shared.data());
    }
    std::vector<double*> seen;
    std::vector<Eigen::Vector2d> seen_centers;
    for (std::size_t i = 0; i < b.tags.size(); ++i) {
      if (!tag_seen[i]) continue;
      if (o.fix_tags) {
        problem->SetParameterBlockConstant(placements[i]);
        continue;
      }
      const TagPlacement& t = b.tags[i];
      problem->AddResidualBlock(new DiagonalPrior({0, 0, 0}, {t.sigma_mm, t.sigma_mm, t.sigma_rad}),
                                o.robust_priors ? new ceres::CauchyLoss(2.0) : nullptr, placements[i]);
      seen.push_back(placements[i]);
      seen_centers.push_back(centers[i]);
    }
    if (o.hold_tag_set && seen.size() >= 3) problem->AddResidualBlock(new TagSetHeld(seen_centers), nullptr, seen);
    for (std::size_t v = 0; v < poses.size(); ++v) {
      if (!view_corners[v]) continue;
      if (o.fix_poses)
        problem->SetParameterBlockConstant(poses[v]);
      else if (const ViewLens own = view_lens(b, v); own.moves())
        problem->AddResidualBlock(new ViewLensPrior(own.prior), nullptr, poses[v]);
    }
  }
};

}  // namespace

int own_count(const Bundle& b, std::size_t view) { return view_lens(b, view).moves() ? kOwn : kPose; }

Lens lens_of(const Bundle& b, std::size_t view) {
  return view < b.view_lenses.size() ? with_own(b.lens, b.view_lenses[view].own) : b.lens;
}

std::array<Eigen::Vector2d, 4> outward_px(const std::array<Eigen::Vector2d, 4>& corners_px) {
  std::array<Eigen::Vector2d, 4> out;
  for (std::size_t k = 0; k < 4; ++k) {
    const Eigen::Vector2d along = (corners_px[(k + 1) % 4] - corners_px[k]).normalized(),
                          back = (corners_px[(k + 3) % 4] - corners_px[k]).normalized();
    const double sine = std::abs(along.x() * back.y() - along.y() * back.x());
    out[k] = sine > 0 ? Eigen::Vector2d(-(along + back) / sine) : Eigen::Vector2d::Zero();
  }
  return out;
}

Eigen::Vector3d bundle_point_mm(const Bundle& b, const BundleCorner& c) {
  const std::array<double, 4> shared = {b.edge_mm, b.surface.bow_mm[0], b.surface.bow_mm[1], b.surface.bow_mm[2]};
  if (c.tag < 0) return board_point(c, b.surface, shared.data(), nullptr, nullptr, nullptr);
  const TagPlacement& t = b.tags[c.tag];
  const std::array<double, 3> placement = {t.shift_mm.x(), t.shift_mm.y(), t.turn_rad};
  return board_point(c, b.surface, shared.data(), placement.data(), nullptr, nullptr);
}

std::array<BundleCorner, 4> corners_to_see(const Bundle& b, std::size_t view, std::size_t tag, const Tag& believed,
                                           double z_mm, double sigma_px) {
  const std::array<Eigen::Vector2d, 4> corners_mm = tag_corners_mm(believed);
  std::array<BundleCorner, 4> out;
  std::array<Eigen::Vector3d, 4> p;
  for (std::size_t k = 0; k < 4; ++k) {
    BundleCorner& c = out[k];
    c.view = static_cast<int>(view);
    c.tag = static_cast<int>(tag);
    c.center_mm = believed.center_mm;
    c.offset_mm = corners_mm[k] - believed.center_mm;
    c.z_mm = z_mm;
    c.sigma_px = sigma_px;
    p[k] = b.views[view] * bundle_point_mm(b, c);
  }
  std::array<Eigen::Vector2d, 4> q;
  project(lens_of(b, view), p, q);
  const std::array<Eigen::Vector2d, 4> outward = outward_px(q);
  for (std::size_t k = 0; k < 4; ++k) {
    out[k].q_px = p[k].z() > 0 ? q[k] : Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());
    out[k].outward = outward[k];
  }
  return out;
}

Eigen::Vector2d bundle_flat_mm(const Bundle& b, const BundleCorner& c) {
  Bundle flat;  // the corner alone
  flat.surface.size_mm = b.surface.size_mm;
  flat.edge_mm = b.edge_mm;
  BundleCorner corner = c;
  if (c.tag >= 0) {
    flat.tags = {b.tags[c.tag]};
    corner.tag = 0;
  }
  return bundle_point_mm(flat, corner).head<2>();
}

std::vector<Eigen::Vector2d> bundle_residuals_px(const Bundle& b) {
  const mrcal_lensmodel_t model = model_of(b.lens);
  std::vector<Lens> lenses;
  for (std::size_t v = 0; v < b.views.size(); ++v) lenses.push_back(lens_of(b, v));
  std::vector<Eigen::Vector2d> out;
  out.reserve(b.corners.size());
  for (const BundleCorner& c : b.corners) {
    const Eigen::Vector3d v = b.views[c.view] * bundle_point_mm(b, c);
    mrcal_point2_t q;
    const mrcal_point3_t p = {{v.x(), v.y(), v.z()}};
    if (v.z() > 0 && mrcal_project(&q, nullptr, nullptr, &p, 1, &model, lenses[c.view].intrinsics.data()))
      out.emplace_back(Eigen::Vector2d(q.x, q.y) + b.spread_px * c.outward - c.q_px);
    else
      out.emplace_back(Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN()));
  }
  return out;
}

BundleSummary solve_bundle(Bundle& b, const BundleOptions& o) {
  Work work(b);
  work.build(b, o);
  BundleSummary out;
  if (work.problem->NumResidualBlocks() == 0)
    fail("the photos", "hold no corners to solve from", "photograph the whole board, sharp");
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_SCHUR;
  options.num_threads = 1;  // one order of sums: the same bits on every machine
  options.max_num_iterations = o.max_iterations;
  options.function_tolerance = 1e-12;
  options.parameter_tolerance = 1e-12;
  options.gradient_tolerance = 1e-12;
  // Minimum damping. Without it the numerator and denominator of a rational lens may leave Cholesky no digits, and
  // Ceres prints a warning.
  options.max_trust_region_radius = 1e9;
  options.logging_type = ceres::SILENT;
  options.use_nonmonotonic_steps = false;
  auto ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  bool free_pose = false;
  for (std::size_t v = 0; v < work.poses.size(); ++v)
    if (work.view_corners[v]) {
      ordering->AddElementToGroup(work.poses[v], 0);
      free_pose = true;
    }
  ordering->AddElementToGroup(work.lens.data(), 1);
  ordering->AddElementToGroup(work.shared.data(), 1);
  for (std::size_t i = 0; i < work.placements.size(); ++i)
    if (work.tag_seen[i]) ordering->AddElementToGroup(work.placements[i], 1);
  if (free_pose) options.linear_solver_ordering = ordering;
  ceres::Solver::Summary summary;
  ceres::Solve(options, work.problem.get(), &summary);
  if (summary.termination_type == ceres::FAILURE)
    fail("the solve for lens and poses", "could not start: " + summary.message,
         "check that board.json describes the photographed board");
  b.lens.intrinsics.assign(work.lens.begin(), work.lens.end());
  for (std::size_t v = 0; v < b.views.size(); ++v)
    if (work.view_corners[v]) {
      b.views[v] = to_isometry(work.poses[v]);
      const double* const own = work.poses[v] + kPose;
      if (own_count(b, v) == kOwn) b.view_lenses[v].own = {{own[0], own[1]}, std::exp(own[2])};
    }
  b.edge_mm = work.shared[0];
  b.surface.bow_mm = {work.shared[1], work.shared[2], work.shared[3]};
  b.spread_px = work.shared[kShared - 1];
  for (std::size_t i = 0; i < b.tags.size(); ++i)
    if (work.tag_seen[i]) {
      b.tags[i].shift_mm = {work.placements[i][0], work.placements[i][1]};
      b.tags[i].turn_rad = work.placements[i][2];
    }
  out.cost = summary.final_cost;
  out.iterations = static_cast<int>(summary.iterations.size());
  out.converged = summary.termination_type == ceres::CONVERGENCE;
  return out;
}

namespace {

// Columns of each free block of shared parameters.
using Columns = std::map<const double*, int>;

// Sets names, priors and columns of lens, edge and bow, and tags.
Columns lay_out_columns(const Bundle& b, const BundleOptions& o, Work& work, BundleEquations& out) {
  ceres::Problem& problem = *work.problem;
  Columns column;
  const auto add = [&](double* block, int size) {
    if (!problem.HasParameterBlock(block) || problem.IsParameterBlockConstant(block)) return -1;
    const int at = out.columns;
    column[block] = at;
    out.columns += size;
    return at;
  };
  static constexpr const char* kLensNames[] = {"fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"};
  const int n_lens = static_cast<int>(work.lens.size());
  out.lens_at = add(work.lens.data(), n_lens);
  if (out.lens_at >= 0) {
    const auto sigma = has_core_and_few(b.lens) ? lens_prior_sigma(b.lens) : std::vector<double>(n_lens, 1e9);
    for (int i = 0; i < n_lens; ++i) {
      out.prior_sigma.push_back(sigma[i]);
      out.name.push_back("lens." + (i < 12 ? std::string(kLensNames[i]) : std::to_string(i)));
    }
  }
  out.shared_at = add(work.shared.data(), kShared);
  if (out.shared_at >= 0) {
    const std::vector<double> sigma = shared_prior_sigma(o);
    out.prior_sigma.insert(out.prior_sigma.end(), sigma.begin(), sigma.end());
    out.name.insert(out.name.end(),
                    {"tags.edge_mm", "board.bow_mm[0]", "board.bow_mm[1]", "board.bow_mm[2]", "tags.spread_px"});
    const bool manifold = problem.GetManifold(work.shared.data()) != nullptr;
    out.bow_held = manifold && o.fix_bow;
    out.edge_held = manifold && !o.fix_bow;
  }
  for (std::size_t i = 0; i < work.placements.size(); ++i)
    out.tag_at.push_back(work.tag_seen[i] ? add(work.placements[i], 3) : -1);
  return column;
}

// Adds one residual block to the equations of its view, or to the priors'.
void add_residual(const Work& work, const Columns& column, const std::map<const double*, std::size_t>& view_of,
                  ceres::ResidualBlockId id, bool fix_poses, BundleEquations& out) {
  std::vector<double*> blocks;
  work.problem->GetParameterBlocksForResidualBlock(id, &blocks);
  const ceres::CostFunction* cost = work.problem->GetCostFunctionForResidualBlock(id);
  const int m = cost->num_residuals();
  std::vector<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> J;
  std::vector<double*> raw;
  for (const int size : cost->parameter_block_sizes()) J.emplace_back(m, size);
  raw.reserve(J.size());
  for (auto& j : J) raw.push_back(j.data());
  Eigen::VectorXd r(m);
  if (!cost->Evaluate(blocks.data(), r.data(), raw.data())) return;
  BundleEquations::OfView* view = nullptr;
  std::size_t pose_block = 0;
  for (std::size_t k = 0; k < blocks.size(); ++k)
    if (const auto at = view_of.find(blocks[k]); at != view_of.end()) {
      view = &out.views[at->second];
      pose_block = k;
    }
  // Parameters fixed by a manifold have no derivative.
  for (std::size_t k = 0; k < blocks.size(); ++k)
    if (blocks[k] == work.shared.data()) {
      if (out.bow_held) J[k].middleCols(1, 3).setZero();
      if (out.edge_held) {
        J[k].leftCols(1).setZero();
        J[k].rightCols(1).setZero();
      }
    }
  Eigen::MatrixXd& information = view ? view->information : out.prior;
  Eigen::VectorXd& gradient = view ? view->gradient : out.prior_gradient;
  for (std::size_t k = 0; k < blocks.size(); ++k) {
    const auto ck = column.find(blocks[k]);
    if (ck == column.end()) continue;
    gradient.segment(ck->second, J[k].cols()) += J[k].transpose() * r;
    for (std::size_t l = 0; l < blocks.size(); ++l) {
      const auto cl = column.find(blocks[l]);
      if (cl != column.end())
        information.block(ck->second, cl->second, J[k].cols(), J[l].cols()) += J[k].transpose() * J[l];
    }
    if (view && !fix_poses) view->B.middleCols(ck->second, J[k].cols()) += J[pose_block].transpose() * J[k];
  }
  if (view && !fix_poses) {
    view->used = true;
    view->H += J[pose_block].transpose() * J[pose_block];
    view->g += J[pose_block].transpose() * r;
  }
}

}  // namespace

BundleEquations bundle_equations(const Bundle& b, const BundleOptions& o) {
  Work work(b);
  BundleOptions plain = o;
  plain.cauchy_sigma = 0;
  plain.robust_priors = false;
  work.build(b, plain);

  BundleEquations out;
  const Columns column = lay_out_columns(b, o, work, out);
  const int columns = out.columns;
  out.views.resize(b.views.size());
  for (std::size_t i = 0; i < out.views.size(); ++i) {
    BundleEquations::OfView& v = out.views[i];
    const int own = own_count(b, i);
    v.H = Eigen::MatrixXd::Zero(own, own);
    v.g = Eigen::VectorXd::Zero(own);
    v.B = Eigen::MatrixXd::Zero(own, columns);
    v.information = Eigen::MatrixXd::Zero(columns, columns);
    v.gradient = Eigen::VectorXd::Zero(columns);
  }
  out.prior = Eigen::MatrixXd::Zero(columns, columns);
  out.prior_gradient = Eigen::VectorXd::Zero(columns);
  std::map<const double*, std::size_t> view_of;
  for (std::size_t v = 0; v < work.poses.size(); ++v) view_of[work.poses[v]] = v;

  std::vector<ceres::ResidualBlockId> ids;
  work.problem->GetResidualBlocks(&ids);
  for (const auto id : ids) add_residual(work, column, view_of, id, o.fix_poses, out);
  for (auto& v : out.views) {
    if (!v.used || columns == 0) continue;
    const Eigen::LDLT<Eigen::MatrixXd> factor(v.H);
    v.information -= v.B.transpose() * factor.solve(v.B);
    v.gradient -= v.B.transpose() * factor.solve(v.g);
  }
  // Rows without any derivative (fixed by a manifold) get their prior, so the matrix stays invertible.
  for (int i = 0; i < columns; ++i) {
    double sum = out.prior(i, i);
    for (const auto& v : out.views) sum += v.information(i, i);
    if (!(sum > 0)) out.prior(i, i) = 1e30;
  }
  return out;
}

Eigen::MatrixXd shared_covariance(const Eigen::MatrixXd& information) {
  return inverse_information(information, 1e-14);
}

Eigen::Matrix<double, 3, 6> center_by_pose(const Eigen::Isometry3d& T_camera_board) {
  // center = -R^T t
  const Pose pose = to_pose(T_camera_board);
  Eigen::Matrix<double, 3, 3, Eigen::RowMajor> R;
  std::array<double, 27> R_by_r;
  mrcal_R_from_r(R.data(), R_by_r.data(), pose.data());
  const Eigen::Vector3d t(pose[3], pose[4], pose[5]);
  Eigen::Matrix<double, 3, 6> D;
  for (int k = 0; k < 3; ++k) {
    Eigen::Matrix3d dR;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) dR(i, j) = R_by_r[(i * 3 + j) * 3 + k];
    D.col(k) = -dR.transpose() * t;
  }
  D.rightCols<3>() = -R.transpose();
  return D;
}

Eigen::MatrixXd center_by_own(const Bundle& b, std::size_t view) {
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(3, own_count(b, view));
  out.leftCols<6>() = center_by_pose(b.views[view]);
  return out;
}

BundleUncertainty bundle_uncertainty(const Bundle& b, const BundleOptions& o) {
  const BundleEquations e = bundle_equations(b, o);
  Eigen::MatrixXd S = e.prior;
  for (const auto& v : e.views) S += v.information;
  const Eigen::MatrixXd C = shared_covariance(S);
  const auto n_lens = static_cast<Eigen::Index>(b.lens.intrinsics.size());

  BundleUncertainty out;
  out.lens = Eigen::MatrixXd::Zero(n_lens, n_lens);
  if (e.lens_at >= 0) out.lens = C.block(e.lens_at, e.lens_at, n_lens, n_lens);
  if (e.shared_at >= 0) {
    if (!e.edge_held) out.edge_sigma_mm = std::sqrt(C(e.shared_at, e.shared_at));
    if (!e.bow_held) out.bow_mm2 = C.block<3, 3>(e.shared_at + 1, e.shared_at + 1);
  }
  for (const int at : e.tag_at) {
    if (at < 0)
      out.tag_sigma.emplace_back(0, 0, 0);
    else
      out.tag_sigma.emplace_back(C.diagonal().segment<3>(at).cwiseMax(0).cwiseSqrt());
  }
  for (std::size_t i = 0; i < e.name.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    double limit = 0.5 * e.prior_sigma[i];
    if (e.lens_at >= 0 && has_core_and_few(b.lens) && i < 4)
      limit =
          i < 2 ? kFocalKnown * std::abs(b.lens.intrinsics[i]) : kCenterKnown * std::max(b.lens.width, b.lens.height);
    if (S(at, at) < 1e29 && std::sqrt(std::max(C(at, at), 0.0)) > limit) out.not_determined.push_back(e.name[i]);
  }
  for (std::size_t v = 0; v < e.views.size(); ++v) {
    Matrix6 P = Matrix6::Zero();
    Eigen::Matrix3d center = Eigen::Matrix3d::Zero(), own = Eigen::Matrix3d::Zero();
    if (e.views[v].used) {
      const Eigen::MatrixXd& H = e.views[v].H;
      const Eigen::MatrixXd Hinv = H.ldlt().solve(Eigen::MatrixXd::Identity(H.rows(), H.cols()));
      const Eigen::MatrixXd G = Hinv * e.views[v].B, of_own = Hinv + G * C * G.transpose();
      P = of_own.topLeftCorner<6, 6>();
      if (of_own.rows() == kOwn) own = of_own.bottomRightCorner<3, 3>();
      const Eigen::MatrixXd D = center_by_own(b, v);
      center = D * of_own * D.transpose();
    }
    out.pose.push_back(P);
    out.center_mm2.push_back(center);
    out.own_lens.push_back(own);
  }
  return out;
}

Lens plain_lens(const std::string& model, double focal_px, int width, int height) {
  Lens lens;
  lens.model = model;
  lens.width = width;
  lens.height = height;
  lens.intrinsics.assign(lens_parameter_count(model), 0.0);
  lens.intrinsics[0] = lens.intrinsics[1] = focal_px;
  lens.intrinsics[2] = (width - 1) / 2.0;
  lens.intrinsics[3] = (height - 1) / 2.0;
  return lens;
}

namespace {

// Used board and pixel points of each view. `in_space`: of a bent sheet, which is not a plane for a homography.
struct ViewPoints {
  std::vector<cv::Point2f> board, pixel;
  std::vector<cv::Point3f> in_space;
};

std::vector<ViewPoints> points_by_view(const Bundle& b) {
  std::vector<ViewPoints> views(b.views.size());
  for (const BundleCorner& c : b.corners) {
    if (!c.used) continue;
    const Eigen::Vector3d p = bundle_point_mm(b, c);
    views[c.view].board.emplace_back(static_cast<float>(p.x()), static_cast<float>(p.y()));
    views[c.view].pixel.emplace_back(static_cast<float>(c.q_px.x()), static_cast<float>(c.q_px.y()));
    if (b.surface.bend)
      views[c.view].in_space.emplace_back(static_cast<float>(p.x()), static_cast<float>(p.y()),
                                          static_cast<float>(p.z()));
  }
  if (b.surface.bend) return views;  // bent_pose() finds gross outliers itself
  // Gross outliers (a misplaced tag, a false corner) must not affect initial guesses.
  for (ViewPoints& v : views) {
    if (v.board.size() < 8) continue;
    std::vector<unsigned char> inlier;
    const double tolerance = 0.01 * std::max(b.lens.width, b.lens.height);  // permits lens distortion
    const cv::Mat H = cv::findHomography(v.board, v.pixel, cv::RANSAC, tolerance, inlier, 2000, 0.999);
    if (H.empty()) continue;
    ViewPoints kept;
    for (std::size_t i = 0; i < inlier.size(); ++i)
      if (inlier[i]) {
        kept.board.push_back(v.board[i]);
        kept.pixel.push_back(v.pixel[i]);
      }
    if (kept.board.size() >= std::max<std::size_t>(4, v.board.size() / 2)) v = kept;
  }
  return views;
}

// Converts OpenCV's rotation vector and translation.
Eigen::Isometry3d isometry_of(const cv::Mat& rotation, const cv::Mat& translation) {
  cv::Mat R;
  cv::Rodrigues(rotation, R);
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) T.linear()(r, c) = R.at<double>(r, c);
    T.translation()[r] = translation.at<double>(r);
  }
  return T;
}

// The pose of a bent sheet from points in no common plane (SQPnP in RANSAC), or nothing if too few points agree.
// `error_px` returns its error, with each point's limited to the tolerance.
std::optional<Eigen::Isometry3d> bent_pose(const Bundle& b, const ViewPoints& v, const cv::Matx33d& K,
                                           double& error_px) {
  constexpr int kFewest = 6;
  const double tolerance = 0.01 * std::max(b.lens.width, b.lens.height);  // permits lens distortion
  if (v.in_space.size() < kFewest) return std::nullopt;
  cv::Mat rotation, translation;
  std::vector<int> inliers;
  try {
    if (!cv::solvePnPRansac(v.in_space, v.pixel, K, cv::noArray(), rotation, translation, false, 300,
                            static_cast<float>(tolerance), 0.999, inliers, cv::SOLVEPNP_SQPNP))
      return std::nullopt;
  } catch (const cv::Exception&) {
    return std::nullopt;
  }
  if (inliers.size() < std::max<std::size_t>(kFewest, v.in_space.size() / 2)) return std::nullopt;
  const Eigen::Isometry3d T = isometry_of(rotation, translation);
  double sum2 = 0;
  for (std::size_t k = 0; k < v.in_space.size(); ++k) {
    const cv::Point3f& at = v.in_space[k];
    const Eigen::Vector3d p = T * Eigen::Vector3d(at.x, at.y, at.z);
    const double dx = K(0, 0) * p.x() / p.z() + K(0, 2) - v.pixel[k].x,
                 dy = K(1, 1) * p.y() / p.z() + K(1, 2) - v.pixel[k].y;
    sum2 += p.z() > 0 ? std::min(dx * dx + dy * dy, tolerance * tolerance) : tolerance * tolerance;
  }
  error_px = std::sqrt(sum2 / static_cast<double>(2 * v.in_space.size()));
  return T.matrix().allFinite() ? std::optional(T) : std::nullopt;
}

PoseSeed seed_from(const Bundle& b, const std::vector<ViewPoints>& points, double focal_px) {
  PoseSeed out;
  const cv::Matx33d K(focal_px, 0, (b.lens.width - 1) / 2.0, 0, focal_px, (b.lens.height - 1) / 2.0, 0, 0, 1);
  std::vector<double> errors;
  for (const ViewPoints& v : points) {
    out.T_camera_board.push_back(Eigen::Isometry3d::Identity());
    out.found.push_back(false);
    if (b.surface.bend) {
      double error_px = 0;
      if (const auto T = bent_pose(b, v, K, error_px)) {
        out.T_camera_board.back() = *T;
        out.found.back() = true;
        errors.push_back(error_px);
      }
      continue;
    }
    if (v.board.size() < 4) continue;
    std::vector<cv::Point3f> object;
    for (const auto& p : v.board) object.emplace_back(p.x, p.y, 0.0F);
    std::vector<cv::Mat> rotations, translations;
    std::vector<double> error;
    try {
      cv::solvePnPGeneric(object, v.pixel, K, cv::noArray(), rotations, translations, false, cv::SOLVEPNP_IPPE,
                          cv::noArray(), cv::noArray(), error);
    } catch (const cv::Exception&) {
      continue;  // degenerate points: the view is reported as not found
    }
    double best = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < rotations.size(); ++i) {
      const Eigen::Isometry3d T = isometry_of(rotations[i], translations[i]);
      bool in_front = T.matrix().allFinite();
      double sum2 = 0;
      for (std::size_t k = 0; k < object.size() && in_front; ++k) {
        const Eigen::Vector3d p = T * Eigen::Vector3d(object[k].x, object[k].y, 0);
        in_front = p.z() > 0;
        const double dx = focal_px * p.x() / p.z() + K(0, 2) - v.pixel[k].x,
                     dy = focal_px * p.y() / p.z() + K(1, 2) - v.pixel[k].y;
        sum2 += dx * dx + dy * dy;
      }
      if (!in_front || !(sum2 < best)) continue;
      best = sum2;
      out.T_camera_board.back() = T;
      out.found.back() = true;
    }
    if (out.found.back()) errors.push_back(std::sqrt(best / static_cast<double>(2 * object.size())));
  }
  out.median_error_px = errors.empty() ? std::numeric_limits<double>::infinity() : median_of(errors);
  return out;
}

}  // namespace

PoseSeed seed_poses(const Bundle& b, double focal_px) { return seed_from(b, points_by_view(b), focal_px); }

double seed_focal_px(const Bundle& b) {
  const auto points = points_by_view(b);
  const double size = std::max(b.lens.width, b.lens.height);
  constexpr int kCandidates = 17;
  std::vector<double> candidates;
  candidates.reserve(kCandidates);
  for (int i = 0; i < kCandidates; ++i)
    candidates.push_back(0.3 * std::pow(1.25, i) * size);  // up to 10 times the picture's width
  std::vector<std::vector<cv::Point3f>> object;
  std::vector<std::vector<cv::Point2f>> pixel;
  for (const auto& v : points) {
    if (v.board.size() < 4) continue;
    object.emplace_back();
    for (const auto& p : v.board) object.back().emplace_back(p.x, p.y, 0.0F);
    pixel.push_back(v.pixel);
  }
  try {
    if (!b.surface.bend) {  // a bent sheet has no homography
      const cv::Mat K = cv::initCameraMatrix2D(object, pixel, cv::Size(b.lens.width, b.lens.height), 1.0);
      const double f = K.at<double>(0, 0);
      if (std::isfinite(f) && f > 0.1 * size && f < 50 * size) candidates.push_back(f);
    }
  } catch (const cv::Exception&) {
    // too few or degenerate views: only the scan decides
  }
  double best = size, best_error = std::numeric_limits<double>::infinity();
  for (const double f : candidates) {
    const double error = seed_from(b, points, f).median_error_px;
    if (error < best_error) {
      best_error = error;
      best = f;
    }
  }
  return best;
}

namespace {

// Input of mrcal's own solver: every corner is a separate point with one observation.
struct MrcalPoints {
  std::vector<mrcal_pose_t> poses;
  std::vector<mrcal_point3_t> points, pixels;  // of a pixel: x, y, weight
  std::vector<mrcal_observation_point_t> observations;
  double nearest_m = 0, furthest_m = 0;  // from their cameras
};

template <typename Observation>
constexpr bool kHoldsPixel = requires(Observation o) {
  o.px;
};

// Up to mrcal 2.4 an observation contains its pixel. Later versions take pixels separately, and also points for
// triangulation, of which there are none here. `Count` and `Optimize` are mrcal_num_measurements and mrcal_optimize.
// Templates check their arguments only in the branch that fits.
template <typename Observation, typename Count, typename Optimize>
mrcal_stats_t solve_by_mrcal(Count count_measurements, Optimize optimize, const Lens& lens, MrcalPoints& p,
                             std::vector<Observation>& observations, std::vector<double>& intrinsics) {
  const mrcal_lensmodel_t model = model_of(lens);
  mrcal_problem_selections_t select{};
  select.do_optimize_intrinsics_core = true;
  select.do_optimize_intrinsics_distortions = true;
  select.do_optimize_extrinsics = true;
  select.do_apply_regularization = false;
  const mrcal_problem_constants_t constants = {0.1 * p.nearest_m, 10 * p.furthest_m};
  const int size[2] = {lens.width, lens.height};
  const int n_points = static_cast<int>(p.points.size()), n_poses = static_cast<int>(p.poses.size()),
            n_obs = static_cast<int>(observations.size());
  const int states = mrcal_num_states(1, n_poses, 0, n_points, n_points, 0, select, &model);
  std::vector<double> state(static_cast<std::size_t>(states)), x;
  const auto bytes = [](const std::vector<double>& v) { return static_cast<int>(v.size() * sizeof(double)); };
  if constexpr (kHoldsPixel<Observation>) {
    for (std::size_t i = 0; i < observations.size(); ++i) observations[i].px = p.pixels[i];
    x.resize(static_cast<std::size_t>(
        count_measurements(0, n_obs, 0, 0, 1, n_poses, 0, n_points, n_points, select, &model)));
    return optimize(state.data(), bytes(state), x.data(), bytes(x), intrinsics.data(), p.poses.data(), nullptr,
                    p.points.data(), nullptr, 1, n_poses, 0, n_points, n_points, nullptr, observations.data(), 0, n_obs,
                    nullptr, &model, size, select, &constants, 0, 0, 0, false, false);
  } else {
    x.resize(static_cast<std::size_t>(
        count_measurements(0, n_obs, nullptr, 0, 0, 0, 1, n_poses, 0, n_points, n_points, select, &model)));
    return optimize(state.data(), bytes(state), x.data(), bytes(x), intrinsics.data(), p.poses.data(), nullptr,
                    p.points.data(), nullptr, 1, n_poses, 0, n_points, n_points, nullptr, observations.data(), 0, n_obs,
                    nullptr, 0, nullptr, p.pixels.data(), &model, size, select, &constants, 0, 0, 0, false, false);
  }
}

}  // namespace

MrcalCheck check_with_mrcal(const Bundle& b) {
  constexpr double kMeter = 1e-3;  // mrcal's internal scales suit meters
  std::vector<double> intrinsics = b.lens.intrinsics;
  std::vector<int> slot(b.views.size(), -1);
  MrcalPoints seen;
  std::vector<double> sigmas;
  double nearest = std::numeric_limits<double>::infinity(), furthest = 0;
  // mrcal requires observations sorted by point, then camera; every corner is a separate point here.
  for (const BundleCorner& c : b.corners) {
    if (!c.used) continue;
    const Eigen::Vector3d p = bundle_point_mm(b, c);
    const double range = (b.views[c.view] * p).norm();
    nearest = std::min(nearest, range);
    furthest = std::max(furthest, range);
    if (slot[c.view] < 0) {
      slot[c.view] = static_cast<int>(seen.poses.size());
      const Pose pose = to_pose(b.views[c.view]);
      mrcal_pose_t m;
      for (int i = 0; i < 3; ++i) {
        m.r.xyz[i] = pose[i];
        m.t.xyz[i] = kMeter * pose[3 + i];
      }
      seen.poses.push_back(m);
    }
    mrcal_observation_point_t o{};
    o.icam.intrinsics = 0;
    o.icam.extrinsics = slot[c.view];
    o.i_point = static_cast<int>(seen.points.size());
    // Position under the common lens, because mrcal has one lens.
    const OwnLens own = view_lens(b, static_cast<std::size_t>(c.view)).own;
    Eigen::Vector2d q = c.q_px - b.spread_px * c.outward;
    if (b.lens.intrinsics.size() >= 4) {
      const Eigen::Vector2d principal(b.lens.intrinsics[2], b.lens.intrinsics[3]);
      q = principal + (q - principal - own.shift_px) / own.focal_ratio;
    }
    seen.pixels.push_back(mrcal_point3_t{{q.x(), q.y(), own.focal_ratio / c.sigma_px}});
    seen.observations.push_back(o);
    seen.points.push_back(mrcal_point3_t{{kMeter * p.x(), kMeter * p.y(), kMeter * p.z()}});
    sigmas.push_back(c.sigma_px);
  }
  MrcalCheck out;
  if (seen.observations.empty()) return out;
  seen.nearest_m = kMeter * nearest;
  seen.furthest_m = kMeter * furthest;
  const mrcal_stats_t stats =
      solve_by_mrcal(&mrcal_num_measurements, &mrcal_optimize, b.lens, seen, seen.observations, intrinsics);
  if (stats.rms_reproj_error__pixels < 0) fail("mrcal's own solver", "gave up", "check the photos' residuals");
  Bundle theirs = b;
  theirs.lens.intrinsics = intrinsics;
  for (std::size_t v = 0; v < b.views.size(); ++v) {
    if (slot[v] < 0) continue;
    const mrcal_pose_t& m = seen.poses[slot[v]];
    const Pose pose = {m.r.xyz[0],          m.r.xyz[1],          m.r.xyz[2],
                       m.t.xyz[0] / kMeter, m.t.xyz[1] / kMeter, m.t.xyz[2] / kMeter};
    theirs.views[v] = to_isometry(pose.data());
    out.max_center_mm = std::max(out.max_center_mm,
                                 (theirs.views[v].inverse().translation() - b.views[v].inverse().translation()).norm());
  }
  const auto ours_px = bundle_residuals_px(b), theirs_px = bundle_residuals_px(theirs);
  double sum2 = 0;
  int n = 0;
  for (std::size_t i = 0; i < b.corners.size(); ++i) {
    if (!b.corners[i].used) continue;
    out.max_shift_px = std::max(out.max_shift_px, (ours_px[i] - theirs_px[i]).norm());
    sum2 += theirs_px[i].squaredNorm() / (b.corners[i].sigma_px * b.corners[i].sigma_px);
    n += 2;
  }
  out.rms_px = std::sqrt(sum2 / n) * median_of(sigmas);
  return out;
}

}  // namespace burin
