#include "burin/calib/photo/lamp_unknowns.h"

#include <algorithm>

#include "burin/calib/light/lamp_area.h"

namespace burin {

void put_lamp(const Unknowns& x, const LampSize& given, double unit_mm, Light& light) {
  light.position_mm = x.segment<3>(unknown::lamp_position);
  light.size = !given.is_point() ? given
                                 : lamp_size({x[unknown::size2], {x[unknown::sides2], x[unknown::sides2 + 1]}}, unit_mm,
                                             light.position_mm.norm());
  light.axis = (Eigen::Vector3d(x[unknown::spot], x[unknown::spot + 1], 0) - light.position_mm).normalized();
  light.falloff_exponent = std::max(0.0, x[unknown::spot + 2]);
}

}  // namespace burin
