// burin/calib/photo/lamp_unknowns.h - the lamp of a fit's unknowns. Frame: board, mm.
#pragma once

#include "burin/calib/photo/unknowns.h"
#include "burin/scene/light.h"

namespace burin {

/// Puts a lamp's position, area, axis and falloff from a fit's unknowns into `light`; its area is `given` if a person
/// gave it.
void put_lamp(const Unknowns& x, const LampSize& given, double unit_mm, Light& light);

}  // namespace burin
