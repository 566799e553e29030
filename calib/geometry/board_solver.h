// burin/calib/geometry/board_solver.h - lens, poses, bow and tag positions from the tags seen in all photos, robustly,
// with uncertainty.
//
// One Cauchy-weighted solve finds what contradicts the rest: single corners, a tag in one photo, a tag in all of them
// (it lies somewhere else than board.json says, or is peeling), a photo (moved, another focal length). What is left is
// solved by least squares, with each photo's own noise, and its covariance taken.
//
// The board frame is that of the tags as a set: their mean shift, turn and growth against board.json are zero by
// definition, and uncertainties are relative to that frame. A common growth of the black squares (ink, paper) is solved
// for, so that the scale of everything comes from where the tags are, not from how large they were printed. Frames:
// board (mm), camera, pixels (center of the top-left pixel is (0, 0)). docs/model.md 9.
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

/// The tags found in one picture of a view. A view may have several (one under each lamp): they share its pose.
struct ViewTags {
  std::string view;
  std::filesystem::path file;  ///< a photo to name in messages
  std::vector<TagDetection> tags;
  std::vector<RejectedTag> rejected;  ///< for messages only
};

/// What solve_board() takes as known, and what it leaves out.
struct BoardSolverOptions {
  std::string lens_model;    ///< empty: the smallest of OPENCV4, 5, 8 that the data support
  std::optional<Lens> lens;  ///< a lens that is known: a start, or fixed
  bool fix_lens = false;
  bool check_with_mrcal = true;
  int min_tags = 3;                    ///< views with fewer are left out
  std::vector<std::string> leave_out;  ///< views that do not count; whoever names them says why
  double outlier_sigma = 5;            ///< corners further from their prediction are left out
  bool own_lenses = true;  ///< whether each view may have a lens of its own (OwnLens) if the tags ask for it
};

/// One measured corner and what became of it.
struct SolvedCorner {
  std::string view;
  int picture = 0;  ///< index into the ViewTags that were given
  int tag = 0;      ///< id
  int corner = 0;   ///< 0 lower-left, 1 lower-right, 2 upper-right, 3 upper-left
  Eigen::Vector2d q_px{0, 0};
  Eigen::Vector2d residual_px{0, 0};  ///< measured minus predicted
  double sigma_px = 0;                ///< per axis, as weighted in the end
  bool used = true;
};

/// What the tags in the photos say: lens, poses, bow and tags, each with its covariance.
struct BoardSolution {
  Lens lens;
  Eigen::MatrixXd lens_covariance;
  std::vector<View> views;                                   ///< with center sigma, RMS and tag count
  std::vector<Eigen::Matrix3d> center_covariance_mm2;        ///< one a view, board axes
  std::vector<Eigen::Matrix<double, 6, 6>> pose_covariance;  ///< rotation vector (added to log R), translation (mm)
  Eigen::Vector3d bow_mm{0, 0, 0};
  Eigen::Vector3d bow_sigma_mm{0, 0, 0};
  std::vector<Tag> tags;                   ///< of board.json, where they really are; those that were used
  std::vector<Eigen::Vector3d> tag_sigma;  ///< x, y (mm), turn (rad), one a tag
  double edge_mm = 0, edge_sigma_mm = 0;   ///< how much further out the tags' sides are than size_mm says
  std::vector<SolvedCorner> corners;
  double rms_px = 0;                   ///< of the used corners, per axis
  double rms_board_mm = 0;             ///< the same on the board, roughly: rms_px over pixels per mm
  std::vector<std::string> odd_views;  ///< left out as of another focal length, or moved
  /// By how much lenses differ from view to view, where each view was found to have its own: then it is solved for.
  std::optional<LensScatter> lens_scatter;
  bool lenses_differ = false;  ///< views fitted one by one differ beyond chance, whether that was followed or not
  /// By how much focal lengths differ from view to view: the standard deviation of their logarithms. 0: they do not.
  /// Where views have no lenses of their own, covariances and the bundle's sigmas count it.
  double focal_scatter = 0;
  std::vector<std::string> not_determined;  ///< names of parameters that the photos hardly determine
  std::vector<Finding> findings;            ///< views, tags and corners left out, and why
  std::optional<MrcalCheck> check;
  Bundle bundle;          ///< as solved, with the corners' final weights: for bundle_equations()
  BundleOptions options;  ///< of its last solve
};

/// Throws Error if fewer than two views (three without a known lens) are left.
BoardSolution solve_board(const Board& board, const std::vector<ViewTags>& pictures, int width, int height,
                          const BoardSolverOptions& options = {}, const Progress& progress = {});

}  // namespace burin
