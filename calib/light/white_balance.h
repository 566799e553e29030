// burin/calib/light/white_balance.h - checks that photos can show lamps' colors: only if all have one white balance. A
// camera with automatic white balance makes every lamp nearly white.
#pragma once

#include <vector>

#include "burin/base/finding.h"
#include "burin/capture/session.h"

namespace burin {

/// A warning, for a session of photos in color under several lamps, if EXIF reports automatic white balance. Raw files
/// store none. Photos without this field pass.
std::vector<Finding> check_white_balance(const Session& session);

}  // namespace burin
