// burin/calib/verdict/at_bounds.h - unknowns at the bounds of their physical range after a fit: the photos do not
// determine them.
#pragma once

#include <vector>

#include "burin/base/finding.h"
#include "burin/calib/photo/photo_problem.h"
#include "burin/scene/bench.h"

namespace burin {

/// True if the fit left this unknown, a logarithm of all photos, on a bound.
bool is_on_bound(const Problem& data, const State& state, int unknown);

/// Reports roughness, depth, the face's roughness and spotlights that ended on a bound, with the remedy. In `bench`'s
/// verdict they become not determined: an optimizer's bound is no measurement.
std::vector<Finding> judge_bounds(const Problem& data, const Stage& stage, const State& state, Bench& bench);

}  // namespace burin
