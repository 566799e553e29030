// burin/calib/verdict/odd_photos.h - photos that the model fits far worse than the others, and their effect on the
// estimates. A second lamp or a window appears at its mirror image, in one photo only.
#pragma once

#include <vector>

#include "burin/calib/verdict/photo_uncertainty.h"
#include "burin/calib/verdict/refinement.h"

namespace burin {

/// Adds to `uncertainty` a misfit for each view whose residuals, in units of the camera's noise, are several times the
/// other views'. The shift of the estimates without this view joins the shifts. `photos` are in the problem's order
/// (Uncertainty::part_photo indexes them). Fewer than four views give no result.
void add_odd_photos(const std::vector<PhotoFit>& photos, Uncertainty& uncertainty);

}  // namespace burin
