// burin/calib/verdict/effect_findings.h - deviations of a measured setup from the paper's model, in words.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "burin/base/finding.h"
#include "burin/scene/bench.h"
#include "burin/scene/board.h"

namespace burin {

/// A finding for a brushed face, backlash, uneven screws, another cross-section, glossy paper and unmodeled light, each
/// with its remedy; empty for a setup without them.
std::vector<Finding> effect_findings(const Bench& bench, const Board& board);

}  // namespace burin
