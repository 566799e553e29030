// burin/calib/photo/photo_fit.h - minimizes a problem over what a stage frees. Ceres moves the unknowns; each photo's
// residuals are compressed to its normal equations.
#pragma once

#include <string>

#include "burin/base/progress.h"
#include "burin/calib/photo/photo_problem.h"

namespace burin {

/// Minimizes over what `stage` frees, until the cost falls by less than `tolerance` (relative). Returns the cost;
/// `state` moves.
double solve(const Problem& data, const Stage& stage, int max_iterations, double tolerance, State& state,
             const Progress& progress, const std::string& stage_name);

}  // namespace burin
