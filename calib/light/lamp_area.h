// burin/calib/light/lamp_area.h - parametrizes an area light for the fits by three numbers. From a point on, photos
// depend on them nearly linearly. docs/model.md 9, 'Effects'.
#pragma once

#include <array>

#include "burin/scene/light.h"

namespace burin {

/// Variances of an area's points about its middle, in squares of some unit. size2 is twice their sum, for a disk the
/// square of its radius. sides2 is twice their difference along the longer side and across, times cosine and sine of
/// twice this side's angle. It is 0 for a disk, which also represents a uniformly lit square.
struct LampArea {
  double size2 = 0;
  std::array<double, 2> sides2{0, 0};
};

LampArea lamp_area(const LampSize& size, double unit_mm);

/// A point, a disk, or (with sides2) a panel without sigmas. The shorter side is at least a twentieth of the longer. It
/// reaches at most 0.45 of the distance from its middle, the limit of a bench.
LampSize lamp_size(const LampArea& area, double unit_mm, double distance_mm);

/// Derivatives of a panel's numbers by the area's: rows longer side, shorter side (mm), angle (degrees); columns size2,
/// sides2. For panels only.
std::array<std::array<double, 3>, 3> panel_slopes(const LampArea& area, double unit_mm);

}  // namespace burin
