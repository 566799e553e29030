// burin/calib/photo/photo_fit.h - minimizes a problem over a stage's free unknowns. Ceres moves the unknowns; each
// photo's residuals are compressed to its normal equations.
#pragma once

#include <string>

#include "burin/base/progress.h"
#include "burin/calib/photo/photo_problem.h"

namespace burin {

/// Minimizes over the free unknowns of `stage`, until the relative decrease of the cost is less than `tolerance`.
/// Returns the cost and moves `state`.
double solve(const Problem& data, const Stage& stage, int max_iterations, double tolerance, State& state,
             const Progress& progress, const std::string& stage_name);

}  // namespace burin
