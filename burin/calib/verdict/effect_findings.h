// burin/calib/verdict/effect_findings.h - what of a measured bench departs from the paper's model, in words.
#pragma once

#include <vector>

#include "burin/render/bench.h"
#include "burin/render/finding.h"

namespace burin {

/// A brushed face, backlash, uneven screws, another cross-section, each with what holds it; empty for a bench without.
std::vector<Finding> effect_findings(const Bench& bench);

}  // namespace burin
