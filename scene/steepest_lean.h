// burin/scene/steepest_lean.h - largest angle between a groove's walls and the face: the cut-off of its glint.
// docs/model.md 2.4 for the paper's cross-section, 2.6 and 2.7 for a rounded V. Burrs are ignored.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "burin/scene/groove.h"
#include "burin/scene/groove_profile.h"

namespace burin {

/// The angle of the steepest wall, radians; lengths in um.
inline double steepest_lean(const GrooveProfile& profile, double width_um, double depth_um) {
  const double radius_um = profile.tip_radius_um > 0 ? profile.tip_radius_um : width_um / 4;
  if (profile.kind == GrooveProfile::Kind::paper) return 2 * std::atan(groove_rim(4 * radius_um, depth_um));
  const double flank = profile.flank_deg * std::numbers::pi / 180;
  return depth_um >= radius_um ? flank : std::min(flank, std::acos(1 - depth_um / radius_um));
}

}  // namespace burin
