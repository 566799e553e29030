// burin/calib/geometry/lens_solver.h - a lens and one pose per view, from points whose places on a flat or slightly
// bowed target are known.
//
// Focal length from homographies, poses from IPPE, then Ceres over mrcal's projection (burin/calib/geometry/bundle.h).
// The lens model is the smallest of OPENCV4, 5 and 8 that the data support, by the Bayesian information criterion,
// unless one is named. Frames: the target's own (its board frame, mm), camera, pixels (center of the top-left pixel is
// (0, 0)). docs/model.md 9.
#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "burin/calib/geometry/bundle.h"
#include "burin/scene/lens.h"

namespace burin {

/// What one photo shows of the target.
struct TargetView {
  std::string name;
  std::vector<Eigen::Vector2d> p_target_mm;
  std::vector<Eigen::Vector2d> q_px;
  std::vector<double> sigma_px;  ///< per axis, one a point; empty: all 1
};

/// How solve_lens() chooses and fits a lens.
struct LensSolverOptions {
  std::string model;             ///< "LENSMODEL_OPENCV8"; empty: chosen from the data
  bool solve_bow = false;        ///< of the target, three quadratic terms
  double cauchy_sigma = 0;       ///< scale of the Cauchy loss, in sigmas; 0: plain least squares
  bool check_with_mrcal = true;  ///< solve again with mrcal's own optimizer and compare
};

/// A lens found from photos of a chessboard, with what it leaves unexplained.
struct LensSolution {
  Lens lens;
  Eigen::MatrixXd covariance;                      ///< of lens.intrinsics, for the noise that the residuals show
  std::vector<Eigen::Isometry3d> T_camera_target;  ///< one a view
  Eigen::Vector3d bow_mm{0, 0, 0};
  double rms_px = 0;        ///< per axis, weighted by 1 / sigma (sigma 1: plain)
  double rms_point_px = 0;  ///< the same per point, sqrt(2) larger: what OpenCV prints
  std::vector<double> view_rms_point_px;
  std::vector<std::vector<Eigen::Vector2d>> residual_px;  ///< measured minus predicted, a list a view
  MrcalCheck check;                                       ///< all zero if it was not asked for
  std::vector<std::string> not_determined;
};

/// Throws Error for fewer than three views, a view with fewer than four points, or arrays that do not match.
/// `target_mm`: the rectangle over which the bow is measured.
LensSolution solve_lens(const std::vector<TargetView>& views, int width, int height, const Eigen::Vector2d& target_mm,
                        const LensSolverOptions& options = {});

/// Solves the bundle for a named lens model, or for the smallest that the data support; the bundle's lens says only the
/// picture's size, or is a start of the same or a smaller model of the OPENCV family. Every model starts from the next
/// smaller one.
BundleSummary solve_with_lens_model(Bundle& bundle, const BundleOptions& options, const std::string& model);

/// Schwarz's criterion of a solved bundle, whose noise is unknown: of two that explain the same corners, the one with
/// the smaller number is to be believed. Counts the lens' parameters, and three for each view whose own lens moves.
double information_criterion(const BundleSummary& summary, const Bundle& bundle);

}  // namespace burin
