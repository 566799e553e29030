// burin/optimize/design/weak_scratches.h - pruning: selection of the weakest scratches.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "burin/optimize/design/design_views.h"
#include "burin/optimize/design/stroke_search.h"
#include "burin/optimize/design_options.h"

namespace burin {

/// The scratches to remove among the first `movable`, in order of removal, as many as drop_share, drop_light or
/// drop_error allow. One scratch always remains. `views` must show the scratches. `light_sum` is each one's light in
/// all views, in units of each view's own white; otherwise views of a bright lamp would dominate. Fewer result if
/// `stop` (may be empty) returns true before.
std::vector<std::size_t> weak_scratches(std::vector<StrokeView> views, const StrokeRules& rules,
                                        const Scratches& scratches, std::size_t movable,
                                        const std::vector<double>& light_sum, const DesignOptions& options,
                                        const std::function<bool()>& stop = {});

}  // namespace burin
