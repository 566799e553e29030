// burin/optimize/design/crossing_loss.h - loss of light at crossings in the search, for cut rims (Crossings::deepest).
//
// Search and rendering use whole strokes, because cut pieces take twenty times as long. The remaining light is rendered
// now and then, place by place, and held in between. A stroke pays for the light that it takes from crossed strokes.
// docs/model.md 6.9, 6.10, docs/design.md.
#pragma once

#include <vector>

#include "burin/base/image.h"
#include "burin/optimize/design/design_views.h"

namespace burin {

/// Estimates the light after crossings, as CrossingLoss of each view. `views` must be rendered with the grooves as they
/// will be cut; `uncut` are the radiances of the same grooves without cuts. `cover` becomes CrossingLoss::cover.
void see_crossings(std::vector<WorkView>& views, const std::vector<double>& log_exposure, std::vector<Image> uncut,
                   double cover);

/// Resets the losses, for renderings of cut grooves.
void forget_crossings(std::vector<WorkView>& views);

/// Multiplies a view's radiance, or the gradient by it, with the remaining share.
inline void leave_what_crossings_do(const WorkView& view, Image& image) {
  for (std::size_t i = 0; i < view.crossings.kept.data.size(); ++i) image.data[i] *= view.crossings.kept.data[i];
}

/// Increase of the squared errors of all views if a stroke crosses a pixel along one pixel's length, for the light
/// taken from others there (views as last rendered). It is negative at places with too much light. No pixels if nothing
/// is lost.
Image crossing_cost(const std::vector<WorkView>& views, const std::vector<double>& log_exposure);

}  // namespace burin
