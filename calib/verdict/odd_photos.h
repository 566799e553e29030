// burin/calib/verdict/odd_photos.h - photos that the model fits far worse than the others, and their effect on the
// estimates. A second lamp or a window appears at its mirror image, in one photo only.
#pragma once

#include <string>
#include <vector>

#include "burin/calib/verdict/photo_uncertainty.h"
#include "burin/calib/verdict/refinement.h"

namespace burin {

/// Adds to `uncertainty` a misfit for each view whose residuals, in units of the camera's noise, are several times the
/// other views'. The shift of the estimates without this view joins the shifts. `photos` are in the problem's order
/// (Uncertainty::part_photo indexes them). Fewer than four views give no result.
void add_odd_photos(const std::vector<PhotoFit>& photos, Uncertainty& uncertainty);

/// True if all photos of the view fit about as well as the median photo: within the factor by which views of clean
/// setups differ.
bool fits_as_usual(const std::vector<PhotoFit>& photos, const std::string& view);

}  // namespace burin
