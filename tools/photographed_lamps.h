// tools/photographed_lamps.h - the lamps under which a board is photographed. Each lamp of a design's views shines
// alone, because a photo measures a single lamp.
#pragma once

#include <string>
#include <vector>

#include "burin/optimize/design_file.h"
#include "burin/scene/bench.h"

namespace burin {

/// The lamps of a view one by one, without sun and surroundings, which have no switch. For a view without lamps,
/// returns its lights unchanged. Throws Error for lights missing in `bench`.
std::vector<std::string> photographed_lamps(const DesignView& view, const Bench& bench);

/// The lamps of all views, each once.
std::vector<std::string> photographed_lamps(const DesignSpec& design, const Bench& bench);

/// The lamps of a bench: all its lights except sun and surroundings.
std::vector<std::string> lamps_of(const Bench& bench);

}  // namespace burin
