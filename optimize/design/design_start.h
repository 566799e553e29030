// burin/optimize/design/design_start.h - the limits of a design's scratches, and initial scratches. Frame: board, mm.
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

/// Throws Error naming the first option out of range, and for a carve area too small for scratches.
void check_options(const DesignOptions& options, const Board& board);

/// The limits of machine and design together. Throws Error if they leave no length.
CarvingLimits design_limits(const Board& board, const Bench& bench, const DesignOptions& options);

/// The rules of the search: lengths of strokes for this mean length.
StrokeRules stroke_rules(const CarvingLimits& limits, double mean_length_mm, const Bench& bench, const Board& board,
                         int candidates);

/// Scratches from the ends of strokes.
Scratches scratches_of(const std::vector<Stroke>& strokes);

/// Random positions in the carve area, in random directions.
Scratches random_start(std::size_t count, const CarvingLimits& limits, double mean_length_mm, std::uint64_t seed);

/// Projects every scratch to its limits; a hopeless scratch restarts at a random place. Throws Error if there is no
/// room.
void settle(Scratches& scratches, const CarvingLimits& limits, double mean_length_mm, std::uint64_t seed);

}  // namespace burin
