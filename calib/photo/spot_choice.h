// burin/calib/photo/spot_choice.h - tests bare lamps for falloff with angle (spotlights). docs/model.md 9, 'Effects'.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "burin/base/progress.h"
#include "burin/calib/photo/photo_problem.h"

namespace burin {

/// Least exponent of a spotlight: a bare lamp explains smaller ones.
inline constexpr double kLeastFalloff = 0.3;

/// Sets the numbers of a spotlight (unknown::spot) with this exponent, aimed at the board's middle.
void make_spot(const Board& board, double exponent, double* spot);

/// Tests each bare lamp by itself. Makes it a spotlight (Problem::is_spot and its numbers in `state`, all unknowns
/// fitted with them) if this explains photos clearly better. With weaker evidence, the change of the answer with a
/// spotlight is added to `pointed_to` (over all unknowns, global_index()). Takes one look at the photos' equations, and
/// a fit for each predicted spotlight. The caller weighs the photos. Returns true if any lamp became a spotlight.
bool choose_spots(const Stage& stage, Problem& data, State& state, std::vector<Eigen::VectorXd>& pointed_to,
                  const Progress& progress);

}  // namespace burin
