// burin/calib/photo/geometry_agreement.h - tests photos' pixels and the tags' corners for agreement about cameras, bow
// and lens. docs/model.md 9.26.
//
// Corners depend on geometry alone. Pixels depend on the whole model of metal, light and sensor. Unmodeled effects give
// like errors in many pixels. Thousands of these would move the cameras by many times the tolerance of the corners. If
// two measurements contradict each other beyond chance, the sigmas of the less trusted one are stretched until they
// agree (the Birge ratio, here of the pixels alone).
// that is less to be trusted are stretched until they do not (the ratio of Birge, of the pixels alone).
#pragma once

#include "burin/calib/geometry/geometry_prior.h"
#include "burin/calib/photo/normal_matrices.h"

namespace burin {

/// Factor on the tags' weight beyond their own noise and the pixels' information: 1 if both agree within chance. Take
/// directions of the geometry in which the tags' information is 1 and the pixels' is diagonal, mu_i. gamma_i is the
/// pixels' score at the tags' optimum, and S_i is the scatter of scores between the board's squares. Then
///
///   sum over i  gamma_i^2 / (S_i + mu_i^2)
///
/// is the number of directions on average, or four of its sigmas more by chance. From there to twice as much the factor
/// rises to s, which gives the distance between both answers its expected value with the pixels' own sigmas:
///
///   sum over i  gamma_i^2 / (mu_i (s + mu_i)) = number of directions.
///
/// Directions with almost no information from pixels are left out. `system`: near the optimum, with any weight.
double tags_weight(const NormalSystem& system, const GeometryPrior& prior);

}  // namespace burin
