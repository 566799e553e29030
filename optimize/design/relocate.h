// burin/optimize/design/relocate.h - re-insertion of the scratches of least marginal contribution.
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

/// Moves the scratches of least marginal contribution (at most this share of the first `movable`) to the places of all
/// views with most missing light, if this pays. Then it searches a better place for each scratch, until `stop` returns
/// true. The views must be rendered. Returns the moved scratches, ascending. The same seed gives the same bits.
std::vector<std::size_t> relocate(Scratches& scratches, const std::vector<WorkView>& views,
                                  const std::vector<double>& log_exposure, const CarvingLimits& limits,
                                  const StrokeRules& rules, std::size_t movable, double share, std::uint64_t seed,
                                  const std::function<bool()>& stop);

/// Searches a better place for each scratch with its cuts (improve_cut()). The views must be rendered with cut grooves,
/// and have the mean loss at crossings (see_crossings()).
std::vector<std::size_t> relocate_cut(Scratches& scratches, const std::vector<WorkView>& views,
                                      const std::vector<double>& log_exposure, const CarvingLimits& limits,
                                      const StrokeRules& rules, const Metal& metal, std::size_t movable,
                                      std::uint64_t seed, const std::function<bool()>& stop);

}  // namespace burin
