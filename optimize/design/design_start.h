// burin/optimize/design/design_start.h - the rules that a design's scratches keep, and scratches to start from.
// Frame: board, mm.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "burin/optimize/design/stroke_search.h"
#include "burin/optimize/design_options.h"
#include "burin/optimize/toolpath/carving_limits.h"
#include "burin/scene/bench.h"
#include "burin/scene/board.h"
#include "burin/scene/scratches.h"

namespace burin {

/// Throws Error naming the first option that is out of range, and for a carve area too small to carve in.
void check_options(const DesignOptions& options, const Board& board);

/// The rules of the machine and of the design together. Throws Error if they leave no length.
CarvingLimits design_limits(const Board& board, const Bench& bench, const DesignOptions& options);

/// Those of the search: how long strokes are whose mean length would be this.
StrokeRules stroke_rules(const CarvingLimits& limits, double mean_length_mm, const Bench& bench, const Board& board,
                         int candidates);

/// Scratches with these ends.
Scratches scratches_of(const std::vector<Stroke>& strokes);

/// Anywhere in the carve area, in any direction.
Scratches random_start(std::size_t count, const CarvingLimits& limits, double mean_length_mm, std::uint64_t seed);

/// Moves every scratch to where it may be carved; one that is hopeless where it lies starts somewhere else. Throws
/// Error if there is no room.
void settle(Scratches& scratches, const CarvingLimits& limits, double mean_length_mm, std::uint64_t seed);

}  // namespace burin
