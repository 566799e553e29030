// burin/optimize/design/weak_scratches.h - the scratches that a design can spare.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "burin/optimize/design/design_views.h"
#include "burin/optimize/design/stroke_search.h"
#include "burin/optimize/design_options.h"

namespace burin {

/// Which of the first `movable` scratches go, in the order in which they are best spared: as many as drop_share,
/// drop_light or drop_error allow. One always stays. `views` must show the scratches; `light_sum` is each one's light
/// in all views, in units of each view's own white, so that a bright lamp's views do not rule. Fewer where `stop` (may
/// be empty) returns true before.
std::vector<std::size_t> weak_scratches(std::vector<StrokeView> views, const StrokeRules& rules,
                                        const Scratches& scratches, std::size_t movable,
                                        const std::vector<double>& light_sum, const DesignOptions& options,
                                        const std::function<bool()>& stop = {});

}  // namespace burin
