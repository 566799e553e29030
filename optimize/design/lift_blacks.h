// burin/optimize/design/lift_blacks.h - pictures whose blacks a room does not allow. docs/model.md 6 (6.8).
//
// Under walls and a sky no scratch is dark in all directions, and the plain face is not either. A picture that asks for
// black there makes every scratch count too much that throws a little light into a dark part, and too little what sets
// a bright part off from a less bright one. Asked for in tones that there are, the same strokes show more of it.
#pragma once

#include <vector>

#include "burin/base/finding.h"
#include "burin/optimize/design/design_views.h"
#include "burin/optimize/loss/loss.h"

namespace burin {

/// What black is taken for, in tones of white's, where the best direction of a scratch sends `contrast` times the light
/// of the worst: 0 from 20 times on.
double black_for(double contrast);

/// Lifts the blacks of gray pictures under other light than one lamp: a tone t becomes black + (1 - black) t, where
/// black is `share` of black_for() the view's contrast. WorkView::wanted keeps the picture as it was asked for, by
/// which designs are judged. Says so. `weights`: of the loss.
std::vector<Finding> lift_blacks(std::vector<WorkView>& views, double share, const LossWeights& weights);

}  // namespace burin
