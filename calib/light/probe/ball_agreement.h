// burin/calib/light/probe/ball_agreement.h - whether several views of a mirror ball show one room: what is no ball, or
// a ball elsewhere or of another size, does not. docs/model.md 11.
#pragma once

#include <span>

#include "burin/calib/light/probe/ball_view.h"
#include "burin/calib/light/probe/mirror_ball.h"

namespace burin {

/// Correlation of what each view shows with the mean of the others, over directions above the face, of log(value): the
/// least of all views. A traced ball has 0.89 and more, with a tenth of the radius wrong 0.7. 0 where fewer than two
/// views see the same directions. Cones about the cameras are left out.
double agreement(std::span<const BallView> views, const MirrorBall& ball, double photographer_rad);

}  // namespace burin
