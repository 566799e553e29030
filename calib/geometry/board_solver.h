// burin/calib/geometry/board_solver.h - robust estimate of lens, poses, bow and tag positions from the tags in all
// photos, with uncertainty.
//
// One solve with a Cauchy loss finds outliers: single corners, a tag in one photo, a tag in all photos (misplaced
// against board.json, or peeling), a photo (moved, another focal length). Least squares fits the rest with each photo's
// own noise and gives the covariance.
//
// The tags as a set define the board frame: their mean shift, turn and growth against board.json are zero.
// Uncertainties are relative to this frame. A common growth of the black squares (ink, paper) is an unknown, so the
// tags' positions and not their printed size determine the scale. Frames: board (mm), camera, pixels (center of the
// top-left pixel is (0, 0)). docs/model.md 9.
#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "burin/base/finding.h"
#include "burin/base/progress.h"
#include "burin/calib/geometry/bundle.h"
#include "burin/capture/tags/tag_detector.h"
#include "burin/scene/bench.h"
#include "burin/scene/board.h"

namespace burin {

/// Tags of one picture of a view. Pictures of a view (one under each lamp) share its pose.
struct ViewTags {
  std::string view;
  std::filesystem::path file;  ///< a photo to name in messages
  std::vector<TagDetection> tags;
  std::vector<RejectedTag> rejected;  ///< for messages only
};

/// Known quantities and exclusions of solve_board().
struct BoardSolverOptions {
  std::string lens_model;    ///< empty: the smallest of OPENCV4, 5, 8 that the data support
  std::optional<Lens> lens;  ///< a known lens: initial guess, or fixed
  bool fix_lens = false;
  bool check_with_mrcal = true;
  int min_tags = 3;                    ///< views with fewer tags are excluded
  std::vector<std::string> leave_out;  ///< excluded views; the caller reports the reason
  double outlier_sigma = 5;            ///< excludes corners with a larger residual
  bool own_lenses = true;              ///< permits a lens per view (OwnLens) if the tags support it
};

/// One measured corner and its use.
struct SolvedCorner {
  std::string view;
  int picture = 0;  ///< index into the given ViewTags
  int tag = 0;      ///< id
  int corner = 0;   ///< 0 lower-left, 1 lower-right, 2 upper-right, 3 upper-left
  Eigen::Vector2d q_px{0, 0};
  Eigen::Vector2d residual_px{0, 0};  ///< measured minus predicted
  double sigma_px = 0;                ///< per axis, final weight
  bool used = true;
};

/// Estimates from the tags: lens, poses, bow and tags, each with its covariance.
struct BoardSolution {
  Lens lens;
  Eigen::MatrixXd lens_covariance;
  std::vector<View> views;                                   ///< with center sigma, RMS and tag count
  std::vector<Eigen::Matrix3d> center_covariance_mm2;        ///< one per view, board axes
  std::vector<Eigen::Matrix<double, 6, 6>> pose_covariance;  ///< rotation vector (added to log R), translation (mm)
  Eigen::Vector3d bow_mm{0, 0, 0};
  Eigen::Vector3d bow_sigma_mm{0, 0, 0};
  std::vector<Tag> tags;                   ///< used tags of board.json, at their estimated positions
  std::vector<Eigen::Vector3d> tag_sigma;  ///< x, y (mm), turn (rad), one per tag
  double edge_mm = 0, edge_sigma_mm = 0;   ///< outward shift of the tags' sides against size_mm
  std::vector<SolvedCorner> corners;
  double rms_px = 0;                   ///< of the used corners, per axis
  double rms_board_mm = 0;             ///< approximate rms_px on the board: rms_px over pixels per mm
  std::vector<std::string> odd_views;  ///< excluded: other focal length, or moved
  /// Scatter of the lenses between views, if each view has its own; then the lenses are unknowns.
  std::optional<LensScatter> lens_scatter;
  bool lenses_differ = false;  ///< the lenses of separately fitted views differ significantly, whether used or not
  /// Standard deviation of the logarithms of the views' focal lengths; 0 if they agree. If views have no lenses of
  /// their own, covariances and the bundle's sigmas include it.
  double focal_scatter = 0;
  std::vector<std::string> not_determined;  ///< parameters that the photos hardly determine
  std::vector<Finding> findings;            ///< excluded views, tags and corners, with reasons
  std::optional<MrcalCheck> check;
  Bundle bundle;          ///< the solved bundle with the final weights, for bundle_equations()
  BundleOptions options;  ///< of the last solve
};

/// Throws Error if fewer than two views (three without a known lens) are left.
BoardSolution solve_board(const Board& board, const std::vector<ViewTags>& pictures, int width, int height,
                          const BoardSolverOptions& options = {}, const Progress& progress = {});

}  // namespace burin
