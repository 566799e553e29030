// burin/calib/geometry/own_focal.h - tests whether all photos of a solved bundle share one lens. Refocusing between
// photos changes the focal length by 0.1 to 3 %, and a stabilizer moves the principal point by some pixels. A single
// lens for all photos then moves the cameras, and the remaining residuals are too small to show it.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "burin/calib/geometry/bundle.h"

namespace burin {

/// Difference of one view's focal length from the bundle's.
struct OwnFocal {
  double log_ratio = 0;
  double sigma = 0;  ///< large for a frontal view, in which focal length and distance trade
};

/// Fits each view's pose and the logarithm of its focal length to all of its corners, also the unused ones. Everything
/// else is fixed. One entry per view of the bundle; empty if the corners do not suffice.
std::vector<std::optional<OwnFocal>> own_focals(const Bundle& bundle);

/// Difference of one view's lens from the bundle's: shift x and y (px), logarithm of the focal length.
struct OwnLensFit {
  Eigen::Vector3d difference{0, 0, 0};
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
};

/// own_focals() with the principal point.
std::vector<std::optional<OwnLensFit>> own_lens_fits(const Bundle& bundle);

/// Scatter of the lenses beyond the fits' sigmas; 0 for each that chance explains.
LensScatter lens_scatter(const std::vector<std::optional<OwnLensFit>>& fits, const std::vector<bool>& counts);

/// Scatter of the views' focal lengths beyond their sigmas: the standard deviation of their logarithms. 0 if chance
/// explains it.
double focal_scatter(const std::vector<std::optional<OwnFocal>>& focals, const std::vector<bool>& counts);

}  // namespace burin
