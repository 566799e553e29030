// burin/calib/photo/photo_weights.h - what each pixel's error is expected to be: noise, what the model misses, grooves
// that differ.
#pragma once

#include "burin/calib/photo/photo_problem.h"

namespace burin {

/// Weighs each photo by its noise, as it follows the predicted brightness, and by what its residuals say the model
/// misses: the relative error m for which the median of |residual| / sqrt(noise^2 + (m prediction)^2) is that of a
/// normal distribution. A photo that the model cannot explain (moved, out of focus) so weighs little by itself.
void weigh_photos(Problem& data, const State& state);

/// The same with grooves that differ: how residuals' squares follow the squares of the prediction's slopes by log alpha
/// and log depth (`slope_error`) counts in a pixel's expected error: where half vectors lean towards the cut-off, a
/// groove a hundredth deeper than the others is many times the noise away from them. A residual counts up to 1.5
/// expected errors. What of it is the grooves' own (model.alpha_jitter, depth_jitter) is found by groove_scatter().
void weigh_photos_and_grooves(Problem& data, const State& state);

}  // namespace burin
