// burin/calib/geometry/bundle.h - the one least-squares problem of the geometry: lens, one pose per view, bow, where
// tags are.
//
// Minimizes, over whatever is not held fixed,
//   sum over corners  rho( |(project(lens, T_camera_board p) + spread outward - q_px) / sigma_px|^2 )  +  priors
// with p the corner on the bowed face: xy = center + shift + R(turn) (1 + edge / half side) offset,
// z = z_mm + bow (Surface); on a bent sheet z_mm along its normal, the bow changing the cylinder. Projection and its
// gradients are mrcal's, chained by hand; the solver is Ceres' with views eliminated first; the covariance is the
// inverse of the same normal matrix, by Schur complement. Every parameter but the poses has a prior, so the normal
// matrix is never singular: "not determined" shows as a sigma that the photos hardly made smaller than the prior's.
// Frames: board (mm), camera, pixels (center of the top-left pixel is (0, 0)). docs/model.md 9.2.
// burin/calib/geometry/lens_solver.h and burin/calib/geometry/board_solver.h are the doors to this room.
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
  Eigen::Vector2d center_mm{0, 0};  ///< believed center of its tag (the point itself, if tag is -1)
  Eigen::Vector2d offset_mm{0, 0};  ///< from there to the corner, as believed
  Eigen::Vector2d q_px{0, 0};
  /// Where it moves in the picture as its tag's sides move outwards there by one pixel (outward_px()).
  Eigen::Vector2d outward{0, 0};
  double z_mm = 0;      ///< above the face
  double sigma_px = 1;  ///< per axis
  int view = 0;         ///< index into Bundle::views
  int tag = -1;         ///< index into Bundle::tags, -1 for a point that cannot move
  bool used = true;
};

/// How the corners of a quadrilateral in a picture, in order, move as each of its sides moves outwards by one pixel.
std::array<Eigen::Vector2d, 4> outward_px(const std::array<Eigen::Vector2d, 4>& corners_px);

/// How a tag lies, relative to what was believed.
struct TagPlacement {
  Eigen::Vector2d shift_mm{0, 0};
  double turn_rad = 0;
  double sigma_mm = 0.2, sigma_rad = 0.02;  ///< prior
};

/// What a view's lens differs by from the bundle's, and the prior of that: standard deviations about no difference, of
/// each axis of the shift and of the logarithm of the focal length. Held where there is no prior.
struct ViewLens {
  OwnLens own;
  LensScatter prior;

  bool moves() const { return prior.shift_px > 0 && prior.focal > 0; }
};

/// A prior that says next to nothing.
inline LensScatter without_prior(const LensScatter& prior) { return {1e6 * prior.shift_px, 1e6 * prior.focal}; }

/// The problem, and after solve_bundle() its solution.
struct Bundle {
  Lens lens;                             ///< of all views but for what each has of its own
  std::vector<Eigen::Isometry3d> views;  ///< T_camera_board
  std::vector<ViewLens> view_lenses;     ///< one a view; the views behind the last have the bundle's
  Surface surface;
  double edge_mm = 0;  ///< by how much every tag's sides lie further out than believed (print gain)
  /// By how much they seem to in pictures, however a tag is seen: a camera that sharpens, or bends its curve, moves the
  /// edges of bright and dark. Along a slanting tag that is more of a millimeter than across.
  double spread_px = 0;
  std::vector<TagPlacement> tags;
  std::vector<BundleCorner> corners;
};

/// What solve_bundle() holds, and how strongly it believes what was believed before.
struct BundleOptions {
  bool fix_lens = false, fix_bow = false, fix_tags = false, fix_poses = false;
  double cauchy_sigma = 0;     ///< scale of the Cauchy loss on a corner, in sigmas; 0: least squares
  bool robust_priors = false;  ///< Cauchy on the tags' placement too, for tags that lie somewhere else
  bool hold_tag_set = true;    ///< the mean shift, turn and growth of the tags' set are zero: it defines the frame
  double bow_prior_mm = 2;
  double edge_prior_mm = 0.1, spread_prior_px = 0.15;
  int max_iterations = 100;
};

/// What the normal matrix at the solution says. Sizes as in Bundle; zeros for what was held fixed.
struct BundleUncertainty {
  Eigen::MatrixXd lens;                           ///< covariance of lens.intrinsics
  std::vector<Eigen::Matrix3d> center_mm2;        ///< of each view's camera center, board axes
  std::vector<Eigen::Matrix<double, 6, 6>> pose;  ///< of (rotation vector added to log R, translation mm)
  std::vector<Eigen::Matrix3d> own_lens;          ///< of (shift x, shift y, px; logarithm of the focal length)
  Eigen::Matrix3d bow_mm2 = Eigen::Matrix3d::Zero();
  double edge_sigma_mm = 0;
  std::vector<Eigen::Vector3d> tag_sigma;  ///< shift x, shift y (mm), turn (rad)
  std::vector<std::string>
      not_determined;  ///< sigma above half the prior's, 2 % of a focal length, 5 % of the picture for its center
};

/// How a solve ended.
struct BundleSummary {
  double cost = 0;  ///< half the sum of squares, priors included
  int iterations = 0;
  bool converged = false;
};

/// Solves in place. Throws Error if Ceres cannot evaluate the start (a point behind the camera).
BundleSummary solve_bundle(Bundle& bundle, const BundleOptions& options);

/// The normal equations at the present values, unit sigma_px taken as true, what each view has of its own eliminated:
/// its pose, and its lens' differences where these move. What one view
/// tells of the parameters that all views share adds up: the information of any set of views is the sum of theirs and
/// the priors', and so what a view more, or half of them, would have told follows without another solve.
/// Shared columns: lens, edge and bow, each tag's placement; blocks that are held have none.
struct BundleEquations {
  /// What one view adds.
  struct OfView {
    /// By its own: the six of its pose (BundleUncertainty::pose), and the three of its lens (own_lens) where it moves.
    Eigen::MatrixXd H;
    Eigen::VectorXd g;            ///< J^T r
    Eigen::MatrixXd B;            ///< its own by the shared columns
    Eigen::MatrixXd information;  ///< of the shared columns, its own eliminated
    Eigen::VectorXd gradient;     ///< by them, its own eliminated
    bool used = false;            ///< has corners, and a pose that is free
  };
  int columns = 0;
  int lens_at = -1, shared_at = -1;  ///< first column; -1: held. shared: edge, bow's three, spread
  bool edge_held = false, bow_held = false;
  std::vector<int> tag_at;          ///< first of three columns, one a tag; -1: held or not seen
  std::vector<std::string> name;    ///< of the lens' and shared columns
  std::vector<double> prior_sigma;  ///< of the same
  Eigen::MatrixXd prior;            ///< information of all priors; 1e30 on the diagonal of columns that nothing moves
  Eigen::VectorXd prior_gradient;
  std::vector<OfView> views;
};
BundleEquations bundle_equations(const Bundle& bundle, const BundleOptions& options);

/// Covariance at the present values, unit sigma_px taken as true.
BundleUncertainty bundle_uncertainty(const Bundle& bundle, const BundleOptions& options);

/// How many numbers a view has of its own: 6, or 9 where its lens moves.
int own_count(const Bundle& bundle, std::size_t view);

/// The lens of one view.
Lens lens_of(const Bundle& bundle, std::size_t view);

/// Inverse of shared information; directions that nothing determines come out huge, not as NaN.
Eigen::MatrixXd shared_covariance(const Eigen::MatrixXd& information);

/// Derivative of the camera's center on the board by BundleUncertainty's pose parameters.
Eigen::Matrix<double, 3, 6> center_by_pose(const Eigen::Isometry3d& T_camera_board);

/// The same by all that a view has of its own (own_count()).
Eigen::MatrixXd center_by_own(const Bundle& bundle, std::size_t view);

/// Predicted minus measured, px, one a corner, used or not. NaN for corners behind the camera.
std::vector<Eigen::Vector2d> bundle_residuals_px(const Bundle& bundle);

/// The four corners of a tag, which is the bundle's number `tag`, as its view number `view` would see them exactly.
/// Pixels are not finite where a corner is behind the camera.
std::array<BundleCorner, 4> corners_to_see(const Bundle& bundle, std::size_t view, std::size_t tag, const Tag& believed,
                                           double z_mm, double sigma_px);

/// The corner's place on the board, mm; and on the flat sheet.
Eigen::Vector3d bundle_point_mm(const Bundle& bundle, const BundleCorner& corner);
Eigen::Vector2d bundle_flat_mm(const Bundle& bundle, const BundleCorner& corner);

/// How mrcal's own solver moves the solution when lens and poses are free again: the same corners, lens model and
/// weights, tags and bow held. An independent check; its optimum should be ours.
struct MrcalCheck {
  double max_shift_px = 0;   ///< of any used corner's projection
  double max_center_mm = 0;  ///< of any camera center
  double rms_px = 0;         ///< of its solution, per axis: weighted residuals times the median sigma
};
MrcalCheck check_with_mrcal(const Bundle& bundle);

/// Poses of the views from their corners and a focal length: homography (RANSAC), IPPE, no distortion. Views whose
/// corners do not determine one come back false.
struct PoseSeed {
  std::vector<Eigen::Isometry3d> T_camera_board;
  std::vector<bool> found;
  double median_error_px = 0;
};
PoseSeed seed_poses(const Bundle& bundle, double focal_px);

/// Focal length that seeds the solve: Zhang's constraints on the homographies, and a scan in case they fail, judged by
/// IPPE's median error.
double seed_focal_px(const Bundle& bundle);

/// A lens of that model without distortion: fx = fy = focal, the center of the picture.
Lens plain_lens(const std::string& model, double focal_px, int width, int height);

}  // namespace burin
