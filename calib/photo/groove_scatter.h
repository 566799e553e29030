// burin/calib/photo/groove_scatter.h - how much grooves differ from one another, in roughness and in depth.
//
// Squared residuals alone do not tell: whatever else is wrong with a pixel that a groove lights is large where the
// groove's slopes are large, too (sampled photos, dust, a groove that lies elsewhere). But a groove that is deeper than
// the others is deeper in all its pixels, and in all photos. So the scores of each groove,
//
//     s_g = J_g^T W r        J_g: the photo's derivative by the groove's log alpha or log depth,
//
// are taken from half photos (the black and the white squares of a chessboard of pixels), and only products of
// different halves count: errors of single pixels have no part in these. If the logarithms vary by variances v from
// groove to groove, then
//
//     E[ sum over g, a != b of s_g^a s_g^b ] = sum over q of v_q trace( sum over a != b of I^a_q I^b_q ),
//     I_q = J^T W J_q,
//
// and the traces are those that grooves with known differences z of unit variance would give: z^T I^a I^b z, from one
// rendering of such grooves (Hutchinson, Communications in Statistics - Simulation and Computation 19, 1990).
// docs/model.md 9.11 to 9.14.
#pragma once

#include <Eigen/Core>

#include "burin/calib/photo/photo_problem.h"

namespace burin {

/// Variances of log alpha and log depth over the grooves (not negative), and their standard errors.
struct GrooveScatter {
  Eigen::Vector2d variance{0, 0};
  Eigen::Vector2d sigma{0, 0};
};

/// At `state`, near the optimum; photos weighed (weigh_photos_and_grooves).
GrooveScatter groove_scatter(const Problem& data, const State& state);

}  // namespace burin
