// burin/calib/photo/lamp_unknowns.h - the lamp that a fit's unknowns say. Frame: board, mm.
#pragma once

#include "burin/calib/photo/unknowns.h"
#include "burin/scene/light.h"

namespace burin {

/// Puts a lamp's place, area, axis and fall-off into `light` as a fit's unknowns have them; its area as `given`, where
/// a person told it.
void put_lamp(const Unknowns& x, const LampSize& given, double unit_mm, Light& light);

}  // namespace burin
