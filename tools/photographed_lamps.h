// tools/photographed_lamps.h - under which lamps a board is photographed: under each that a design's views are lit by,
// alone, since a photo measures the one lamp that was on.
#pragma once

#include <string>
#include <vector>

#include "burin/optimize/design_file.h"
#include "burin/scene/bench.h"

namespace burin {

/// The lamps of a view one by one, without sun and surroundings, which no switch turns off; where there is nothing
/// else, the view's lights as they are. Throws Error for lights that `bench` lacks.
std::vector<std::string> photographed_lamps(const DesignView& view, const Bench& bench);

/// Those of all views, each once.
std::vector<std::string> photographed_lamps(const DesignSpec& design, const Bench& bench);

/// The lamps of a bench: all its lights but sun and surroundings.
std::vector<std::string> lamps_of(const Bench& bench);

}  // namespace burin
