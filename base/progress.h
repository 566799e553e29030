// burin/base/progress.h - how long work tells its caller how far it is.
//
// Libraries call it, never print. The burin program turns it into a bar with time left, on a terminal only.
#pragma once

#include <functional>
#include <string_view>

namespace burin {

/// Called from the calling thread, as often as the work likes: `stage` is a short phrase ("finding tags"),
/// `fraction` runs from 0 to 1 within that stage. May be empty. May throw to stop the work.
using Progress = std::function<void(std::string_view stage, double fraction)>;

}  // namespace burin
