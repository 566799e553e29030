// burin/calib/verdict/effect_findings.h - what of a measured bench departs from the paper's model, in words.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "burin/base/finding.h"
#include "burin/scene/bench.h"
#include "burin/scene/board.h"

namespace burin {

/// A brushed face, backlash, uneven screws, another cross-section, paper's coat, a light that nobody named, each with
/// what holds it; empty for a bench without.
std::vector<Finding> effect_findings(const Bench& bench, const Board& board);

}  // namespace burin
