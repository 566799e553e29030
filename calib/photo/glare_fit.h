// burin/calib/photo/glare_fit.h - glare (burin/capture/glare.h) as photos of a board show it. docs/model.md 5.13, 9.25.
//
// A pixel's predicted value is (1 - share) its own light + share * what K makes of the photo that was taken: K is broad
// and the share small, so the photo serves for the light that it was before, and no whole photo need be rendered.
#pragma once

#include <span>
#include <vector>

#include "burin/calib/light/light_samples.h"
#include "burin/capture/glare.h"
#include "burin/capture/photo.h"
#include "burin/scene/bench.h"

namespace burin {

/// The shape that glare is first looked for with, and all that are tried once there is some: reaches from a tenth of a
/// picture's diagonal to the whole of it. Share 0.
Glare usual_glare(const Lens& lens);
std::vector<Glare> possible_glares(const Lens& lens);

/// Sets `scattered` of views (which make_light_views() made of `merged`) for a glare of that shape.
void add_scattered_light(std::span<const MergedView> merged, const Glare& glare, std::vector<LightView>& views);

/// Takes the glare out of paper's samples: value - share (scattered - value).
void take_glare_from_paper(const std::vector<LightView>& views, double share, const Bench& bench,
                           std::vector<LightSample>& paper);

}  // namespace burin
