// burin/calib/photo/stray_light_choice.h - whether a second lamp or a window shines into the photos, that nobody named.
// docs/model.md 9, "Effects".
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "burin/base/progress.h"
#include "burin/calib/photo/photo_problem.h"
#include "burin/calib/photo/stray_light.h"

namespace burin {

/// Looks for light in what the model leaves of the photos, from every direction but the lamps' own, as glints and face
/// would send it: the likeliest places, the best first; empty where none explains enough to be tried. Renders the
/// photos some hundred times: give it coarse ones. Photos are weighed by the caller.
std::vector<StrayNumbers> likely_stray_lights(const Problem& data, const Stage& stage, const State& state,
                                              const Progress& progress);

/// What a light at the best of these places would leave of the photos' cost, after `iterations` of all that the stage
/// frees. The problem stays without one.
double cost_with_stray(const std::vector<StrayNumbers>& places, Problem data, const Stage& stage, const State& state,
                       int iterations, const Progress& progress);

/// Fits a light at each of these places, beside what else might explain it (glare, whose light photos must have been
/// given), and puts the best into problem, `state` and `stage` where photos are explained clearly better. Else leaves
/// all as it is and says false. Photos are weighed by the caller.
bool fit_stray_light(const std::vector<StrayNumbers>& places, Problem& data, Stage& stage, State& state,
                     const Progress& progress);

/// Of a light that was found as a point's: how far the answer would move if it had the size that photos point to, to
/// first order; nothing where they point to none.
std::optional<Eigen::VectorXd> shift_by_stray_size(const Problem& data, const Stage& stage, const State& state);

}  // namespace burin
