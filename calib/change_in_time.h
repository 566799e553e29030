// burin/calib/change_in_time.h - odd photos that are all of those before, or after, one moment: then something was
// changed at that moment, and is worth one sentence in place of one per photo.
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
  bool odd_after = false;                 ///< whether the odd views come after it
};

/// The change that sets the `odd` views apart from all other views, in the order of the session's photos, which is that
/// of their clock; views that are in `unknown` may lie on either side. None unless there are two odd views and two
/// others, and one moment parts them.
std::optional<ChangeInTime> change_in_time(const Session& session, const std::vector<std::string>& odd,
                                           const std::vector<std::string>& unknown = {});

/// The same of a lamp that was moved: it draws the fit towards itself, so that some view fits hardly worse than the
/// clean ones. The worst of the others, half as many at most, join `odd` until one moment parts them. `residuals`: of
/// each photo its view, and its residual over its noise.
std::optional<ChangeInTime> change_of_lamp(const Session& session,
                                           const std::vector<std::pair<std::string, double>>& residuals,
                                           std::vector<std::string>& odd);

}  // namespace burin
