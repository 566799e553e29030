#include "burin/calib/light/white_balance.h"

#include <set>
#include <string>

#include "burin/capture/exif.h"

namespace burin {

std::vector<Finding> check_white_balance(const Session& session) {
  std::set<std::string> lamps;
  for (const Photo& photo : session.photos) lamps.insert(photo.light);
  if (lamps.size() < 2) return {};
  std::size_t chosen = 0;
  std::string first;
  for (const Photo& photo : session.photos) {
    if (photo.encoding == Encoding::raw) continue;
    const Exif exif = read_exif(photo.file);
    if (exif.channels < 3 || !exif.auto_white.value_or(false)) continue;
    if (chosen++ == 0) first = photo.file.filename().string();
  }
  if (chosen == 0) return {};
  return {make_warning(FindingCode::camera_settings,
                       "the camera chose the white balance of " + std::to_string(chosen) + " of the " +
                           std::to_string(session.photos.size()) + " photos itself (" + first +
                           "): lamps' colors are not to be trusted, since each lamp then looks nearly white",
                       "set the camera to one fixed balance (daylight) for all lamps, or take raw photos; places and "
                       "brightness of lamps do not depend on it")};
}

}  // namespace burin
