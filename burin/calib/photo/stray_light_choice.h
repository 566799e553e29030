// burin/calib/photo/stray_light_choice.h - whether a second lamp or a window shines into the photos, that nobody named.
// docs/model.md 9, "Effects".
#pragma once

#include "burin/calib/photo/photo_problem.h"
#include "burin/render/progress.h"

namespace burin {

/// Looks for light in what the model leaves of the photos, from every direction but the lamps' own, as glints and face
/// would send it; fits the likeliest places, and puts the best of them into problem, `state` and `stage` where
/// photos are explained clearly better. Else leaves all as it is and says false. Renders the photos some hundred times:
/// give it coarse ones. Photos are weighed by the caller.
bool find_stray_light(Problem& data, Stage& stage, State& state, const Progress& progress);

}  // namespace burin
