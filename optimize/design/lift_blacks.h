// burin/optimize/design/lift_blacks.h - targets without black for rooms with ambient light. docs/model.md 6 (6.8).
//
// Under walls and a sky no scratch is dark in all directions, and neither is the plain face. With black in the target,
// squared errors penalize a little light in dark parts too much, and differences between bright parts too little. With
// reachable tones, the same strokes show more of the picture.
#pragma once

#include <vector>

#include "burin/base/finding.h"
#include "burin/optimize/design/design_views.h"
#include "burin/optimize/loss/loss.h"

namespace burin {

/// The tone that replaces black, relative to white's, if the best direction of a scratch sends `contrast` times the
/// light of the worst: 0 from 20 on.
double black_for(double contrast);

/// Lifts the blacks of gray pictures under lights other than one lamp. A tone t becomes black + (1 - black) t, with
/// black = `share` times black_for() of the view's contrast. WorkView::wanted keeps the original picture, which judges
/// the design. Reports each lift. `weights`: of the loss.
std::vector<Finding> lift_blacks(std::vector<WorkView>& views, double share, const LossWeights& weights);

}  // namespace burin
