// burin/calib/photo/coupon_fit.h - fits the photos of a coupon (burin/scene/coupon.h) fan by fan. Each fan has its own
// depth and roughness. All share the dependence of depth on the direction of travel. Lamp, face, affine machine
// calibration, light and blur move along. Frame: board, mm. docs/calibration.md, "The coupon".
//
// Residuals compare each pixel with the renderer's prediction, as in photo_equations.h. Fans are separate: one change
// of all depths at once therefore gives, in each pixel, the derivative by the depth of its own fan.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "burin/base/progress.h"
#include "burin/calib/photo/photo_problem.h"
#include "burin/scene/coupon.h"
#include "burin/scene/scratches.h"

namespace burin {

/// Unknowns of each fan, and the shared ones.
struct FanValues {
  std::vector<double> log_depth, log_alpha;  ///< um; one per fan, at its center
  Eigen::Vector2d travel{0, 0};              ///< log depth rises by this . (unit vector of travel)
  /// and by this . (scratch's middle from its fan's center, in its radii). This keeps a tilted sheet, or errors of the
  /// photos across a fan, out of `travel`.
  Eigen::Vector2d across{0, 0};
};

/// Initial guess: one prior depth per fan from the coupon, and one roughness.
FanValues believed_fans(const Coupon& coupon, double alpha);

/// The commanded scratches with the depth and roughness of these values. Scratches of no fan (date and number) have the
/// mean of all.
Sent scratches_of(const Scratches& told, const Coupon& coupon, const FanValues& values);

/// Data of a fit of fans. The problem's `sent` must be this one's. Scratches with depths of their own count from the
/// material of its board, and the state's depth and roughness must be the board's.
struct FanProblem {
  const Coupon* coupon = nullptr;
  Scratches told;
  FanValues prior;                             ///< weak: values that photos do not constrain stay near it
  Problem data;                                ///< of all photos
  std::vector<std::vector<int>> fan_of_pixel;  ///< [photo][pixel]; -1: none
};

/// Assigns pixels to fans, under this affine machine calibration, and leaves out pixels of the date.
void find_fans(const State& state, FanProblem& problem);

/// Tries depths from a quarter to four times the given ones, and roughnesses from half to double, cell by cell. Keeps
/// the best explanation of the photos.
void try_fans(FanProblem& problem, const State& state, FanValues& values, const Progress& progress);

/// Moves values and state (except cameras) to the optimum. Returns the cost.
double fit_fans(FanProblem& problem, const Stage& stage, int max_iterations, State& state, FanValues& values,
                const Progress& progress);

/// One covariance over the fans' log depths, then their log roughnesses, then travel, then across. It is, number by
/// number, the larger of two estimates: from the curvature, and from scores summed over fans' sectors. The second
/// includes errors common to all pixels of a groove. Cameras and all other unknowns are eliminated, not held.
Eigen::MatrixXd fan_covariance(FanProblem& problem, const Stage& stage, const State& state, const FanValues& values);

/// Sigmas of the weak priors: of the logarithms of depth and roughness.
inline constexpr double kFanDepthPrior = 1.0, kFanAlphaPrior = 0.7;

}  // namespace burin
