// python/design.h - burin::design() for pictures in memory, watched and stopped from Python. Frame: board, mm.
#pragma once

#include <functional>

#include "burin/optimize/design.h"

namespace burin::python {

/// design(). `on_frame` is called once per iteration, and as the start grows. False ends the design, and its result is
/// that of its work so far. An exception from `on_frame` ends the design and passes on. True from `interrupted`, which
/// several threads call often, ends it like false.
DesignResult watched_design(const DesignSpec& spec, const Board& board, const Bench& bench, DesignOptions options,
                            const std::function<bool(const DesignFrame&)>& on_frame,
                            const std::function<bool()>& interrupted);

}  // namespace burin::python
