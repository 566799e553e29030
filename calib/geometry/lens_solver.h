// burin/calib/geometry/lens_solver.h - a lens and one pose per view, from points at known positions of a flat or
// slightly bowed target.
//
// Homographies give the focal length, IPPE the poses; Ceres then fits mrcal's projection
// (burin/calib/geometry/bundle.h). The lens model is the smallest of OPENCV4, 5 and 8 that the data support, by the
// Bayesian information criterion, or a given one. Frames: the target's own (its board frame, mm), camera, pixels
// (center of the top-left pixel is (0, 0)). docs/model.md 9.
#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "burin/calib/geometry/bundle.h"
#include "burin/scene/lens.h"

namespace burin {

/// Points of the target in one photo.
struct TargetView {
  std::string name;
  std::vector<Eigen::Vector2d> p_target_mm;
  std::vector<Eigen::Vector2d> q_px;
  std::vector<double> sigma_px;  ///< per axis, one per point; empty: all 1
};

/// Options of solve_lens().
struct LensSolverOptions {
  std::string model;             ///< "LENSMODEL_OPENCV8"; empty: chosen from the data
  bool solve_bow = false;        ///< of the target, three quadratic terms
  double cauchy_sigma = 0;       ///< scale of the Cauchy loss, in sigmas; 0: plain least squares
  bool check_with_mrcal = true;  ///< solve again with mrcal's own optimizer and compare
};

/// A lens from photos of a chessboard, with its residuals.
struct LensSolution {
  Lens lens;
  Eigen::MatrixXd covariance;                      ///< of lens.intrinsics, with the noise of the residuals
  std::vector<Eigen::Isometry3d> T_camera_target;  ///< one per view
  Eigen::Vector3d bow_mm{0, 0, 0};
  double rms_px = 0;        ///< per axis, weighted by 1 / sigma (sigma 1: plain)
  double rms_point_px = 0;  ///< rms_px per point, sqrt(2) larger, as OpenCV prints it
  std::vector<double> view_rms_point_px;
  std::vector<std::vector<Eigen::Vector2d>> residual_px;  ///< measured minus predicted, one list per view
  MrcalCheck check;                                       ///< all zero if not requested
  std::vector<std::string> not_determined;
};

/// Throws Error for fewer than three views, a view with fewer than four points, or arrays of different sizes.
/// `target_mm`: rectangle on which the bow is defined.
LensSolution solve_lens(const std::vector<TargetView>& views, int width, int height, const Eigen::Vector2d& target_mm,
                        const LensSolverOptions& options = {});

/// Solves the bundle for a given lens model, or for the smallest that the data support. The bundle's lens gives only
/// the picture's size, or is an initial guess of the same or a smaller OPENCV model. Every model starts from the next
/// smaller.
BundleSummary solve_with_lens_model(Bundle& bundle, const BundleOptions& options, const std::string& model);

/// Bayesian information criterion of a solved bundle with unknown noise. Of two fits to the same corners, the smaller
/// value is better. Counts the lens' parameters, and three for each view with its own lens.
double information_criterion(const BundleSummary& summary, const Bundle& bundle);

}  // namespace burin
