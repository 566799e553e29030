// burin/optimize/design/relocate.h - scratches that leave where they are worth least for where the pictures miss most.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "burin/optimize/design/design_views.h"
#include "burin/optimize/design/stroke_search.h"
#include "burin/optimize/toolpath/carving_limits.h"
#include "burin/scene/scratches.h"

namespace burin {

/// Moves the scratches whose absence costs least (at most this share of the first `movable`) to where the pictures of
/// all views miss most, as far as that pays, then searches a better place for each, until `stop` says so. The views
/// must be as rendered. Returns the moved ones, ascending. Same seed, same bits.
std::vector<std::size_t> relocate(Scratches& scratches, const std::vector<WorkView>& views,
                                  const std::vector<double>& log_exposure, const CarvingLimits& limits,
                                  const StrokeRules& rules, std::size_t movable, double share, std::uint64_t seed,
                                  const std::function<bool()>& stop);

/// Searches a better place for each as they cut each other (improve_cut()). The views must be as rendered so, with what
/// crossings leave on average (see_crossings()).
std::vector<std::size_t> relocate_cut(Scratches& scratches, const std::vector<WorkView>& views,
                                      const std::vector<double>& log_exposure, const CarvingLimits& limits,
                                      const StrokeRules& rules, const Metal& metal, std::size_t movable,
                                      std::uint64_t seed, const std::function<bool()>& stop);

}  // namespace burin
