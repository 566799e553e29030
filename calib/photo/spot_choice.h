// burin/calib/photo/spot_choice.h - whether lamps that were taken for bare ones shine less to the side. docs/model.md
// 9, 'Effects'.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "burin/base/progress.h"
#include "burin/calib/photo/photo_problem.h"

namespace burin {

/// The exponent of a spot that is none: what less would explain, a bare lamp does.
inline constexpr double kLeastFalloff = 0.3;

/// The numbers of a spot (unknown::spot) of that exponent, aimed at the board's middle as lamps are.
void make_spot(const Board& board, double exponent, double* spot);

/// Of each lamp that is no spot, by itself: makes it one (Problem::is_spot and its numbers in `state`, all unknowns
/// fitted with them) where that explains photos clearly better. Where photos point to one and do not ask for it, how
/// far the answer would move with it is added to `pointed_to` (over all unknowns, global_index()). Takes one look at
/// the photos' equations, and a fit for each lamp that they foretell a spot of. Photos are weighed by the caller.
/// Whether any is one now.
bool choose_spots(const Stage& stage, Problem& data, State& state, std::vector<Eigen::VectorXd>& pointed_to,
                  const Progress& progress);

}  // namespace burin
