// burin/calib/photo/photo_weights.h - estimates each pixel's expected error: noise, model error, groove-to-groove
// variation.
#pragma once

#include "burin/calib/photo/photo_problem.h"

namespace burin {

/// Weighs each photo by its noise, which depends on the predicted brightness, and by its model error. The relative
/// error m makes the median of |residual| / sqrt(noise^2 + (m prediction)^2) that of a normal distribution. An
/// unexplained photo (moved, out of focus) therefore gets little weight.
void weigh_photos(Problem& data, const State& state);

/// Weighs photos with groove-to-groove variation. The regression of squared residuals on the squares of the
/// prediction's derivatives by log alpha and log depth (`slope_error`) adds to a pixel's expected error. If half
/// vectors lean towards the cut-off, a groove a hundredth deeper than the others differs from them by many times the
/// noise. A residual counts up to 1.5 expected errors. groove_scatter() estimates the grooves' own part
/// (model.alpha_jitter, depth_jitter).
void weigh_photos_and_grooves(Problem& data, const State& state);

}  // namespace burin
