// burin/calib/geometry/bundle.h - bundle adjustment of the geometry: lens, one pose per view, bow, positions of tags.
//
// Minimizes over all free unknowns
//   sum over corners  rho( |(project(lens, T_camera_board p) + spread outward - q_px) / sigma_px|^2 )  +  priors
// with p the corner on the bowed face: xy = center + shift + R(turn) (1 + edge / half side) offset,
// z = z_mm + bow (Surface). On a bent sheet z_mm is along its normal, and the bow changes the cylinder. mrcal projects
// and supplies gradients; this file chains them by hand. Ceres solves and eliminates the views first. The covariance is
// the inverse of the same normal matrix, by Schur complement. Every parameter except the poses has a prior, so the
// normal matrix is never singular. An undetermined parameter keeps a sigma close to its prior's.
// Frames: board (mm), camera, pixels (center of the top-left pixel is (0, 0)). docs/model.md 9.2.
// burin/calib/geometry/lens_solver.h and burin/calib/geometry/board_solver.h are the public API of this folder.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <string>
#include <vector>

#include "burin/scene/bench.h"
#include "burin/scene/board.h"
#include "burin/scene/lens.h"
#include "burin/scene/surface.h"

namespace burin {

/// One corner in one view.
struct BundleCorner {
  Eigen::Vector2d center_mm{0, 0};  ///< prior center of its tag (the point itself, if tag is -1)
  Eigen::Vector2d offset_mm{0, 0};  ///< prior offset of the corner from the center
  Eigen::Vector2d q_px{0, 0};
  /// Motion in the picture as the tag's sides move outwards by one pixel (outward_px()).
  Eigen::Vector2d outward{0, 0};
  double z_mm = 0;      ///< above the face
  double sigma_px = 1;  ///< per axis
  int view = 0;         ///< index into Bundle::views
  int tag = -1;         ///< index into Bundle::tags, -1 for a fixed point
  bool used = true;
};

/// Motion of a quadrilateral's corners in a picture, in order, as each of its sides moves outwards by one pixel.
std::array<Eigen::Vector2d, 4> outward_px(const std::array<Eigen::Vector2d, 4>& corners_px);

/// Placement of a tag relative to its prior.
struct TagPlacement {
  Eigen::Vector2d shift_mm{0, 0};
  double turn_rad = 0;
  double sigma_mm = 0.2, sigma_rad = 0.02;  ///< prior
};

/// Difference of a view's lens from the bundle's, with its prior: standard deviations about zero, of each axis of the
/// shift and of the logarithm of the focal length. Fixed without a prior.
struct ViewLens {
  OwnLens own;
  LensScatter prior;

  /// True if the photo has a lens of its own.
  bool moves() const { return prior.shift_px > 0 && prior.focal > 0; }
};

/// A prior so wide that it has no effect.
inline LensScatter without_prior(const LensScatter& prior) { return {1e6 * prior.shift_px, 1e6 * prior.focal}; }

/// The problem, and after solve_bundle() its solution.
struct Bundle {
  Lens lens;                             ///< common part of all views' lenses
  std::vector<Eigen::Isometry3d> views;  ///< T_camera_board
  std::vector<ViewLens> view_lenses;     ///< one per view; views beyond the end have the bundle's lens
  Surface surface;
  double edge_mm = 0;  ///< outward shift of every tag's sides against the prior (dot gain)
  /// Apparent outward shift in pictures, for any viewing direction. A camera that sharpens, or bends its response,
  /// moves the edges between bright and dark. Along a tilted tag this shift is more millimeters than across.
  double spread_px = 0;
  std::vector<TagPlacement> tags;
  std::vector<BundleCorner> corners;
};

/// Fixed parameters of solve_bundle(), and its losses.
struct BundleOptions {
  bool fix_lens = false, fix_bow = false, fix_tags = false, fix_poses = false;
  double cauchy_sigma = 0;     ///< scale of the Cauchy loss on a corner, in sigmas; 0: least squares
  bool robust_priors = false;  ///< Cauchy loss also on the tags' placement, for misplaced tags
  bool hold_tag_set = true;    ///< the mean shift, turn and growth of the set of tags are zero, which defines the frame
  double bow_prior_mm = 2;
  double edge_prior_mm = 0.1, spread_prior_px = 0.15;
  int max_iterations = 100;
};

/// Covariances from the normal matrix at the solution. Sizes as in Bundle; zeros for fixed parameters.
struct BundleUncertainty {
  Eigen::MatrixXd lens;                           ///< covariance of lens.intrinsics
  std::vector<Eigen::Matrix3d> center_mm2;        ///< of each view's camera center, board axes
  std::vector<Eigen::Matrix<double, 6, 6>> pose;  ///< of (rotation vector added to log R, translation mm)
  std::vector<Eigen::Matrix3d> own_lens;          ///< of (shift x, shift y, px; logarithm of the focal length)
  Eigen::Matrix3d bow_mm2 = Eigen::Matrix3d::Zero();
  double edge_sigma_mm = 0;
  std::vector<Eigen::Vector3d> tag_sigma;  ///< shift x, shift y (mm), turn (rad)
  /// Sigma above half the prior's, 2 % of a focal length, or 5 % of the picture for its center.
  std::vector<std::string> not_determined;
};

/// Result of a solve.
struct BundleSummary {
  double cost = 0;  ///< half the sum of squares, priors included
  int iterations = 0;
  bool converged = false;
};

/// Solves in place. Throws Error if Ceres cannot evaluate the initial guess (a point behind the camera).
BundleSummary solve_bundle(Bundle& bundle, const BundleOptions& options);

/// The normal equations at the present values, for true sigma_px. Each view's own unknowns are eliminated: its pose,
/// and its lens' differences if they move. The contributions of views to the shared parameters add up: the information
/// of any set of views is the sum of theirs and the priors'. So the effect of one more view, or of half of them,
/// follows without another solve. Shared columns: lens, edge and bow, each tag's placement; fixed blocks have none.
struct BundleEquations {
  /// Contribution of one view.
  struct OfView {
    /// By the view's own unknowns: the six of its pose (BundleUncertainty::pose), and the three of its lens (own_lens)
    /// if it moves.
    Eigen::MatrixXd H;
    Eigen::VectorXd g;            ///< J^T r
    Eigen::MatrixXd B;            ///< the view's own unknowns by the shared columns
    Eigen::MatrixXd information;  ///< of the shared columns, own unknowns eliminated
    Eigen::VectorXd gradient;     ///< by the shared columns, own unknowns eliminated
    bool used = false;            ///< has corners and a free pose
  };
  int columns = 0;
  int lens_at = -1, shared_at = -1;  ///< first column; -1: fixed. shared: edge, bow's three, spread
  bool edge_held = false, bow_held = false;
  std::vector<int> tag_at;          ///< first of three columns, one per tag; -1: fixed or not seen
  std::vector<std::string> name;    ///< of the lens' and shared columns
  std::vector<double> prior_sigma;  ///< of the lens' and shared columns
  /// information of all priors; 1e30 on the diagonal of columns without any derivative
  Eigen::MatrixXd prior;
  Eigen::VectorXd prior_gradient;
  std::vector<OfView> views;
};
BundleEquations bundle_equations(const Bundle& bundle, const BundleOptions& options);

/// Covariance at the present values, for true sigma_px.
BundleUncertainty bundle_uncertainty(const Bundle& bundle, const BundleOptions& options);

/// Number of a view's own unknowns: 6, or 9 if its lens moves.
int own_count(const Bundle& bundle, std::size_t view);

/// The lens of one view.
Lens lens_of(const Bundle& bundle, std::size_t view);

/// Inverse of shared information. Undetermined directions have a huge variance, not NaN.
Eigen::MatrixXd shared_covariance(const Eigen::MatrixXd& information);

/// Derivative of the camera's center on the board by BundleUncertainty's pose parameters.
Eigen::Matrix<double, 3, 6> center_by_pose(const Eigen::Isometry3d& T_camera_board);

/// Derivative of the camera's center by all of a view's own unknowns (own_count()).
Eigen::MatrixXd center_by_own(const Bundle& bundle, std::size_t view);

/// Predicted minus measured, px, one per corner, used or not. NaN for corners behind the camera.
std::vector<Eigen::Vector2d> bundle_residuals_px(const Bundle& bundle);

/// The four corners of tag number `tag` of the bundle as predicted in view number `view`, without noise. Pixels are not
/// finite for corners behind the camera.
std::array<BundleCorner, 4> corners_to_see(const Bundle& bundle, std::size_t view, std::size_t tag, const Tag& believed,
                                           double z_mm, double sigma_px);

/// The corner's position on the board, mm; and on the flat sheet.
Eigen::Vector3d bundle_point_mm(const Bundle& bundle, const BundleCorner& corner);
Eigen::Vector2d bundle_flat_mm(const Bundle& bundle, const BundleCorner& corner);

/// Independent check: change of the solution as mrcal's own solver frees lens and poses. Corners, lens model and
/// weights are the same; tags and bow stay fixed. Both optima should agree.
struct MrcalCheck {
  double max_shift_px = 0;   ///< of any used corner's projection
  double max_center_mm = 0;  ///< of any camera center
  double rms_px = 0;         ///< of its solution, per axis: weighted residuals times the median sigma
};
MrcalCheck check_with_mrcal(const Bundle& bundle);

/// Initial guess of the views' poses from their corners and a focal length: homography (RANSAC), IPPE, no distortion.
/// `found` is false for views without a determined pose.
struct PoseSeed {
  std::vector<Eigen::Isometry3d> T_camera_board;
  std::vector<bool> found;
  double median_error_px = 0;
};
PoseSeed seed_poses(const Bundle& bundle, double focal_px);

/// Initial guess of the focal length: Zhang's constraints on the homographies, and a scan in case they fail. The median
/// error of IPPE decides.
double seed_focal_px(const Bundle& bundle);

/// A lens of this model without distortion: fx = fy = focal, principal point at the center of the picture.
Lens plain_lens(const std::string& model, double focal_px, int width, int height);

}  // namespace burin
