// burin/calib/light/probe/ball_agreement.h - checks that several views of a mirror ball show one room. Another object,
// or a ball of wrong place or size, does not. docs/model.md 11.
#pragma once

#include <span>

#include "burin/calib/light/probe/ball_view.h"
#include "burin/calib/light/probe/mirror_ball.h"

namespace burin {

/// Correlation of log(value) of each view with the mean of the others, over directions above the face: the least of all
/// views. A traced ball has 0.89 and more, and 0.7 with a tenth of the radius wrong. 0 if fewer than two views see the
/// same directions. Cones about the cameras are left out.
double agreement(std::span<const BallView> views, const MirrorBall& ball, double photographer_rad);

}  // namespace burin
