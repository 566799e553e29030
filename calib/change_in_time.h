// burin/calib/change_in_time.h - detects odd photos that all precede, or all follow, one moment. Then something changed
// at this moment, and one sentence replaces one per photo.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "burin/capture/session.h"

namespace burin {

/// The moment between two views of a session.
struct ChangeInTime {
  std::string view_before, view_after;
  std::string photo_before, photo_after;  ///< file names: the last photo before it, the first after it
  bool odd_after = false;                 ///< the odd views come after it
};

/// The change that separates the `odd` views from all others in the order of the session's photos, their time order.
/// Views in `unknown` can be on either side. Empty unless there are two odd views and two others, and one moment
/// separates them.
std::optional<ChangeInTime> change_in_time(const Session& session, const std::vector<std::string>& odd,
                                           const std::vector<std::string>& unknown = {});

/// The change for a lamp that was moved. Such a lamp draws the fit towards itself, so that some odd view fits hardly
/// worse than clean ones. The worst of the other views, at most half as many, join `odd` until one moment separates
/// them. `residuals` holds for each photo its view and its residual over its noise.
std::optional<ChangeInTime> change_of_lamp(const Session& session,
                                           const std::vector<std::pair<std::string, double>>& residuals,
                                           std::vector<std::string>& odd);

}  // namespace burin
