// burin/calib/photo/stray_light_choice.h - tests photos for an unmodeled second lamp or window. docs/model.md 9,
// "Effects".
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "burin/base/progress.h"
#include "burin/calib/photo/photo_problem.h"
#include "burin/calib/photo/stray_light.h"

namespace burin {

/// Searches the photos' residuals for light from every direction except the lamps' own, as glints and face would
/// reflect it. Returns the likeliest places, the best first; empty if none explains enough for a trial. Renders the
/// photos some hundred times: give it coarse ones. The caller weighs the photos.
std::vector<StrayNumbers> likely_stray_lights(const Problem& data, const Stage& stage, const State& state,
                                              const Progress& progress);

/// The photos' cost with a light at the best of these places, after `iterations` of the stage's free unknowns. The
/// problem keeps none.
double cost_with_stray(const std::vector<StrayNumbers>& places, Problem data, const Stage& stage, const State& state,
                       int iterations, const Progress& progress);

/// Fits a light at each of these places, together with competing effects (glare, whose light photos must already have).
/// Puts the best into problem, `state` and `stage` if photos are explained clearly better. Otherwise it changes nothing
/// and returns false. The caller weighs the photos.
bool fit_stray_light(const std::vector<StrayNumbers>& places, Problem& data, Stage& stage, State& state,
                     const Progress& progress);

/// For a light found as a point: the change of the answer, to first order, with the size suggested by photos. Empty
/// without one.
std::optional<Eigen::VectorXd> shift_by_stray_size(const Problem& data, const Stage& stage, const State& state);

}  // namespace burin
