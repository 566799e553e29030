// burin/optimize/design/obey.h - a design's scratches brought under all rules of
// burin/optimize/toolpath/carving_limits.h at the least loss.
//
// Rules of pairs (distance, overlap, grooves over one place) are what a design knows nothing of while it searches:
// whether a scratch obeys them depends on all others. So scratches are mended - a hair aside, a little shorter - the
// worthiest first, and those for which that does not help are placed anew where the pictures miss light and the rules
// let them lie. Only what finds no place in several rounds is dropped.
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
  std::vector<std::size_t> rows;              ///< of the scratches given, for each of these, ascending
  std::vector<std::size_t> placed;            ///< those of the rows that lie in a place of their own now
  std::array<std::size_t, kRules> dropped{};  ///< by the first rule that they broke
};

/// `views` must be as rendered with these scratches; they are rendered anew if something is placed. What is in the
/// metal already stays. Same seed, same bits. Once `stop` says so (as in stroke_search.h) nothing more is placed.
Obeying obey(const Scratches& scratches, const CarvingLimits& limits, std::vector<WorkView>& views,
             const std::vector<double>& log_exposure, const StrokeRules& rules, const Metal& metal, std::uint64_t seed,
             const std::function<bool()>& stop = {});

}  // namespace burin
