// burin/calib/photo/geometry_agreement.h - whether photos' pixels and the tags' corners want the same cameras, bow and
// lens. docs/model.md 9.26.
//
// Corners depend on nothing but geometry; pixels on all that the model says of metal, light and sensor. Where the model
// misses something, errors are alike over many pixels, and thousands of them would drag the cameras by many times what
// the corners allow. As between any two measurements that contradict each other beyond chance, the sigmas of the one
// that is less to be trusted are stretched until they do not (the ratio of Birge, of the pixels alone).
#pragma once

#include "burin/calib/geometry/geometry_prior.h"
#include "burin/calib/photo/normal_matrices.h"

namespace burin {

/// By what factor the tags weigh more than their own noise and the pixels' say: 1 where both agree within chance. In
/// directions of the geometry in which the tags' information is 1 and the pixels' mu_i diagonal, with gamma_i the
/// pixels' score where the tags want to be and S_i how the scores of the board's squares scatter,
///
///   sum over i  gamma_i^2 / (S_i + mu_i^2)
///
/// is the number of directions on average, or four of its sigmas more by chance. From there to twice as much the factor
/// rises to s, which makes the distance between both answers with the pixels' own sigmas what it should be:
///
///   sum over i  gamma_i^2 / (mu_i (s + mu_i)) = number of directions.
///
/// Directions of which pixels know next to nothing are left out. `system`: near the optimum, with any weight.
double tags_weight(const NormalSystem& system, const GeometryPrior& prior);

}  // namespace burin
