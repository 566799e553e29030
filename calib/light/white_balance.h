// burin/calib/light/white_balance.h - whether photos can tell lamps' colors: only if all were stored with one white
// balance. A camera that seeks white anew in each photo makes every lamp nearly white.
#pragma once

#include <vector>

#include "burin/base/finding.h"
#include "burin/capture/session.h"

namespace burin {

/// For a session of photos in color under several lamps: a warning where EXIF says that the camera chose the balance of
/// photos itself. Raw files are stored without any. Photos whose header says nothing are taken for good.
std::vector<Finding> check_white_balance(const Session& session);

}  // namespace burin
