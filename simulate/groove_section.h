// burin/simulate/groove_section.h - cross-section of a simulated groove, point by point: height of the metal at x, and
// its slope. Shares nothing with groove_profile.cpp's bands. Units: um; x across the groove, to the right of the
// direction of carving.
#pragma once

#include <optional>

#include "burin/scene/groove_profile.h"

namespace burin {

/// Dimensions of one groove.
struct GrooveSection {
  bool paper = true;  ///< docs/model.md 2.1: the sampler has its normal in closed form
  bool round_v = false;
  double radius_um = 0, flank_slope = 0, depth_um = 0, half_width_um = 0;
  double burr_um[2] = {0, 0}, burr_width_um = 0;  ///< left, right
  double across = 1;
  double reach_um = 0;  ///< the outermost |x|
};
GrooveSection section_of(const GrooveProfile& profile, double width_um, double depth_um);

/// The metal at one place: height above the face (0), and the angle whose tangent is its slope.
struct SectionPoint {
  double height_um, lean;
};
/// Nothing outside of groove and burr.
std::optional<SectionPoint> section_at(const GrooveSection& section, double x_um);

}  // namespace burin
