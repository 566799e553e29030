// burin/calib/verdict/odd_photos.h - photos that the model explains far worse than the others, and what that moves:
// a second lamp or a window shows where its mirror image is, in one photo of all.
#pragma once

#include <vector>

#include "burin/calib/verdict/photo_uncertainty.h"
#include "burin/calib/verdict/refinement.h"

namespace burin {

/// Adds to `uncertainty` a misfit for each view whose residuals, in the camera's noise, are several times the other
/// views'; by how far the answer moves without it is added to the shifts. `photos`: as fitted, in the problem's order
/// (Uncertainty::part_photo points into them). Nothing where views are fewer than four.
void add_odd_photos(const std::vector<PhotoFit>& photos, Uncertainty& uncertainty);

}  // namespace burin
