// burin/calib/verdict/at_bounds.h - unknowns that a fit left on the bounds of what is possible: photos do not hold
// them.
#pragma once

#include <vector>

#include "burin/base/finding.h"
#include "burin/calib/photo/photo_problem.h"
#include "burin/scene/bench.h"

namespace burin {

/// Whether the fit left that unknown, a logarithm of all photos, on a bound.
bool is_on_bound(const Problem& data, const State& state, int unknown);

/// Names roughness, depth, the face's roughness and spots that ended on a bound, with what would hold them, and has
/// `bench`'s verdict say that the photos do not tell them: what an optimizer ran into is no measurement.
std::vector<Finding> judge_bounds(const Problem& data, const Stage& stage, const State& state, Bench& bench);

}  // namespace burin
