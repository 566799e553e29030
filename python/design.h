// python/design.h - burin::design() for pictures in memory, watched and stopped from Python. Frame: board, mm.
#pragma once

#include <functional>

#include "burin/optimize/design.h"

namespace burin::python {

/// design(); `on_frame` is called once an iteration (and as the start grows), and ends the design by false: what there
/// is then is the result. What it throws ends the design, too, and is thrown on.
DesignResult watched_design(const DesignSpec& spec, const Board& board, const Bench& bench, DesignOptions options,
                            const std::function<bool(const DesignFrame&)>& on_frame);

}  // namespace burin::python
