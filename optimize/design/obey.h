// burin/optimize/design/obey.h - final repair of a design: all rules of burin/optimize/toolpath/carving_limits.h at the
// least loss.
//
// The search does not handle rules of pairs (distance, overlap, grooves over one place): a scratch's validity depends
// on all others. The repair moves or shortens scratches slightly, those of most marginal contribution first. Invalid
// remaining scratches are re-inserted at permitted places with missing light. Only scratches without a place after
// several rounds are dropped.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "burin/optimize/design/design_views.h"
#include "burin/optimize/design/stroke_search.h"
#include "burin/optimize/design/to_metal.h"
#include "burin/optimize/toolpath/carving_limits.h"
#include "burin/scene/scratches.h"

namespace burin {

struct Obeying {
  Scratches scratches;                        ///< within all rules
  std::vector<std::size_t> rows;              ///< index among the given scratches, for each of these, ascending
  std::vector<std::size_t> placed;            ///< re-inserted rows
  std::array<std::size_t, kRules> dropped{};  ///< by their first broken rule
};

/// Repairs `scratches`. `views` must be rendered with them; they are rendered again after a re-insertion. Existing
/// grooves stay. The same seed gives the same bits. Once `stop` (as in stroke_search.h) returns true, nothing more is
/// re-inserted.
Obeying obey(const Scratches& scratches, const CarvingLimits& limits, std::vector<WorkView>& views,
             const std::vector<double>& log_exposure, const StrokeRules& rules, const Metal& metal, std::uint64_t seed,
             const std::function<bool()>& stop = {});

}  // namespace burin
