// burin/calib/photo/glare_fit.h - models veiling glare (burin/capture/glare.h) in photos of a board. docs/model.md
// 5.13, 9.25.
//
// A pixel's predicted value is (1 - share) its own light + share * K applied to the photo. K is broad and the share
// small, so the photo approximates the light before the glare, and no whole photo need be rendered.
#pragma once

#include <span>
#include <vector>

#include "burin/calib/light/light_samples.h"
#include "burin/capture/glare.h"
#include "burin/capture/photo.h"
#include "burin/scene/bench.h"

namespace burin {

/// The shape of the first search for glare, and all shapes tried after a detection: reaches from a tenth of a picture's
/// diagonal to the whole of it. Share 0.
Glare usual_glare(const Lens& lens);
std::vector<Glare> possible_glares(const Lens& lens);

/// Sets `scattered` of views (from make_light_views() of `merged`) for a glare of this shape.
void add_scattered_light(std::span<const MergedView> merged, const Glare& glare, std::vector<LightView>& views);

/// Removes glare from paper's samples: value - share (scattered - value).
void take_glare_from_paper(const std::vector<LightView>& views, double share, const Bench& bench,
                           std::vector<LightSample>& paper);

}  // namespace burin
