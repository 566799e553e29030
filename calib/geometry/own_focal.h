// burin/calib/geometry/own_focal.h - whether all photos of a solved bundle have one lens. Focus that a camera sets anew
// for each photo changes its focal length by 0.1 to 3 %, a stabilizer moves its principal point by some pixels; one
// lens for all then moves the cameras, and the residuals that remain are too small to show it by themselves.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "burin/calib/geometry/bundle.h"

namespace burin {

/// How much longer one view's focal length is than the bundle's.
struct OwnFocal {
  double log_ratio = 0;
  double sigma = 0;  ///< large for a view that looks straight at the board: focal length and distance trade there
};

/// Fits each view's pose and the logarithm of its focal length to all corners that the view has, also to those that are
/// not used; everything else is held. One entry per view of the bundle; none if its corners do not allow it.
std::vector<std::optional<OwnFocal>> own_focals(const Bundle& bundle);

/// What one view's lens differs by from the bundle's: shift x and y (px), logarithm of the focal length.
struct OwnLensFit {
  Eigen::Vector3d difference{0, 0, 0};
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
};

/// The same as own_focals() with the principal point.
std::vector<std::optional<OwnLensFit>> own_lens_fits(const Bundle& bundle);

/// By how much lenses scatter beyond the fits' sigmas; 0 each where chance explains it.
LensScatter lens_scatter(const std::vector<std::optional<OwnLensFit>>& fits, const std::vector<bool>& counts);

/// By how much the focal lengths of views scatter beyond their sigmas: the standard deviation of their logarithms. 0 if
/// chance explains it.
double focal_scatter(const std::vector<std::optional<OwnFocal>>& focals, const std::vector<bool>& counts);

}  // namespace burin
