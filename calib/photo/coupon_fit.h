// burin/calib/photo/coupon_fit.h - the photos of a coupon (burin/scene/coupon.h) fitted fan by fan: each fan has a
// depth and a roughness of its own, all share how depth changes with the direction of travel, and lamp, face, machine's
// map, light and blur move along. Frame: board, mm. docs/calibration.md, "The coupon".
//
// Photos are compared pixel by pixel with what the renderer predicts, as in photo_equations.h. Fans lie apart, so one
// change of all depths at once shows, in each pixel, the slope by the depth of the fan that the pixel lies in.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "burin/base/progress.h"
#include "burin/calib/photo/photo_problem.h"
#include "burin/scene/coupon.h"
#include "burin/scene/scratches.h"

namespace burin {

/// What is sought of each fan, and what they share.
struct FanValues {
  std::vector<double> log_depth, log_alpha;  ///< um; a fan's, at its center
  Eigen::Vector2d travel{0, 0};              ///< log depth rises by this . (unit vector of travel)
  /// and by this . (scratch's middle from its fan's center, in its radii): a sheet that is tilted, or what the photos
  /// have wrong across a fan, is no travel.
  Eigen::Vector2d across{0, 0};
};

/// Where all this starts from: one depth a fan as the coupon believes, one roughness.
FanValues believed_fans(const Coupon& coupon, double alpha);

/// The scratches as the machine was told them, with the depth and roughness that these values say. Scratches of no fan
/// (date and number) have the mean of all.
Sent scratches_of(const Scratches& told, const Coupon& coupon, const FanValues& values);

/// What a fit of fans works on. The problem's `sent` is this one's; its board must believe in the material that
/// scratches with depths of their own count from, and the state's depth and roughness be the board's.
struct FanProblem {
  const Coupon* coupon = nullptr;
  Scratches told;
  FanValues prior;                             ///< weak: what photos do not tell stays near it
  Problem data;                                ///< of all photos
  std::vector<std::vector<int>> fan_of_pixel;  ///< [photo][pixel]; -1: none
};

/// Tells pixels by the fan they lie in, under this machine's map, and leaves out those that show the date.
void find_fans(const State& state, FanProblem& problem);

/// Tries depths from a quarter to four times those given, and roughnesses from a half to the double, cell by cell, and
/// takes what explains the photos best.
void try_fans(FanProblem& problem, const State& state, FanValues& values, const Progress& progress);

/// Moves values and state (but cameras) to the optimum. Returns the cost.
double fit_fans(FanProblem& problem, const Stage& stage, int max_iterations, State& state, FanValues& values,
                const Progress& progress);

/// How well the photos tell the values: one covariance over the fans' log depths, then their log roughnesses, then
/// travel, then across. The larger, number by number, of two estimates: from the curvature, and from scores summed over
/// fans' sectors (errors that a groove has in all its pixels). Cameras and all other unknowns are eliminated, not held.
Eigen::MatrixXd fan_covariance(FanProblem& problem, const Stage& stage, const State& state, const FanValues& values);

/// Sigmas of the weak priors: of the logarithms of depth and roughness.
inline constexpr double kFanDepthPrior = 1.0, kFanAlphaPrior = 0.7;

}  // namespace burin
