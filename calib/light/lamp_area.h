// burin/calib/light/lamp_area.h - a lamp's area as fits move it: three numbers that photos follow nearly linearly, from
// a point on. docs/model.md 9, 'Effects'.
#pragma once

#include <array>

#include "burin/scene/light.h"

namespace burin {

/// Variances of an area's points about its middle, in squares of some unit: twice their sum, which for a disk is the
/// square of its radius; and twice their difference along the longer side and across, times cosine and sine of twice
/// that side's turn. The latter are 0 for a disk, which an evenly lit square is taken for.
struct LampArea {
  double size2 = 0;
  std::array<double, 2> sides2{0, 0};
};

LampArea lamp_area(const LampSize& size, double unit_mm);

/// A point, a disk, or (with sides2) a panel, whose sides are at least a twentieth of each other; no larger than 0.45
/// of the distance either way from its middle, which is what a bench takes. Without sigmas.
LampSize lamp_size(const LampArea& area, double unit_mm, double distance_mm);

/// How a panel's numbers follow the area's: rows longer side, shorter side (mm), turn (degrees); columns size2, sides2.
/// For areas that are panels.
std::array<std::array<double, 3>, 3> panel_slopes(const LampArea& area, double unit_mm);

}  // namespace burin
