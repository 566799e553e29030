// burin/base/degrees.h - conversion between degrees, for people and files, and radians, for formulas.
#pragma once

#include <numbers>

namespace burin {

inline constexpr double kDegree_rad = std::numbers::pi / 180;  ///< one degree, in radians
inline constexpr double kRadian_deg = 180 / std::numbers::pi;  ///< one radian, in degrees

}  // namespace burin
