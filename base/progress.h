// burin/base/progress.h - progress reports from work to its caller.
//
// Libraries call it, never print. The burin program turns it into a bar with time left, on a terminal only.
#pragma once

#include <functional>
#include <string_view>

namespace burin {

/// The work calls it from the calling thread, at any rate. `stage` is a short phrase ("finding tags"); `fraction` runs
/// from 0 to 1 within that stage. May be empty. May throw to stop the work.
using Progress = std::function<void(std::string_view stage, double fraction)>;

}  // namespace burin
