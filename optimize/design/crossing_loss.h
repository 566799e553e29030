// burin/optimize/design/crossing_loss.h - what a search knows of grooves that cut each other's rims away
// (Crossings::deepest). Strokes are searched whole, and rendered so: cut into pieces they take twenty times as long. So
// how much of their light crossings leave is rendered now and then, place by place, and in between held; and a stroke
// pays for what it takes from those that it crosses. docs/model.md 6.9, 6.10, docs/design.md.
#pragma once

#include <vector>

#include "burin/base/image.h"
#include "burin/optimize/design/design_views.h"
#include "burin/scene/carve.h"

namespace burin {

/// What crossings leave, into the views' CrossingLoss. `views` must be as rendered with the grooves as they will be
/// cut; `whole` are these as the search has them, and are rendered. `cover`: as CrossingLoss has it.
void see_crossings(std::vector<WorkView>& views, const std::vector<double>& log_exposure, const Carved& whole,
                   double cover);

/// Nothing is lost any more: what is rendered is cut already.
void forget_crossings(std::vector<WorkView>& views);

/// A view's radiance, or the gradient by it, times what crossings leave.
inline void leave_what_crossings_do(const WorkView& view, Image& image) {
  for (std::size_t i = 0; i < view.crossings.kept.data.size(); ++i) image.data[i] *= view.crossings.kept.data[i];
}

/// By how much the squared errors of all views grow where a stroke crosses a pixel along one pixel's length, for the
/// light that it takes from others there (views as rendered last); negative where they show too much. No pixels where
/// nothing is lost.
Image crossing_cost(const std::vector<WorkView>& views, const std::vector<double>& log_exposure);

}  // namespace burin
