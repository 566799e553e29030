// burin/calib/photo/groove_scatter.h - estimates groove-to-groove variation of roughness and depth.
//
// Squared residuals alone do not show it. Any other error of a lit pixel is also large if the groove's derivatives are
// large (sampled photos, dust, a displaced groove). But a deeper groove is deeper in all its pixels, and in all photos.
// The scores of each groove,
//
//     s_g = J_g^T W r        J_g: the photo's derivative by the groove's log alpha or log depth,
//
// come from half photos (the black and the white squares of a chessboard of pixels). Only products of different halves
// count, so errors of single pixels have no part in them. If the logarithms vary by variances v from groove to groove,
// then
//
//     E[ sum over g, a != b of s_g^a s_g^b ] = sum over q of v_q trace( sum over a != b of I^a_q I^b_q ),
//     I_q = J^T W J_q.
//
// Grooves with known differences z of unit variance would give the traces: z^T I^a I^b z, from one rendering of such
// grooves (Hutchinson, Communications in Statistics - Simulation and Computation 19, 1990). docs/model.md 9.11 to 9.14.
#pragma once

#include <Eigen/Core>

#include "burin/calib/photo/photo_problem.h"

namespace burin {

/// Variances of log alpha and log depth over the grooves (not negative), and their standard errors.
struct GrooveScatter {
  Eigen::Vector2d variance{0, 0};
  Eigen::Vector2d sigma{0, 0};
};

/// Estimates at `state`, near the optimum; photos weighed (weigh_photos_and_grooves).
GrooveScatter groove_scatter(const Problem& data, const State& state);

}  // namespace burin
