// burin/render/groove_sums.h - what the grooves that one pixel sees add up to, and how that changes with everything a
// photo can tell about. Found pair by pair in double (exact/exact_sums.h) or in float packets (fast/pixel_slopes.h);
// radiance_chain.h takes it to the bench's parameters. docs/model.md 5.
#pragma once

#include <Eigen/Core>
#include <array>

namespace burin {

struct GrooveSums {
  double light_mm2 = 0;  ///< sum of Dhat G
  double area_mm2 = 0;   ///< that they cover, not clamped
  // Derivatives of light - base * area, the plain face's light that they cover (where they do not cover the pixel
  // whole): by the shared parameters, by the machine's affine, and by what the pixel brings.
  double depth_um = 0, width_um = 0, alpha = 0;
  std::array<double, 6> affine{};
  std::array<Eigen::Vector2d, 4> corner_mm{Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero(),
                                           Eigen::Vector2d::Zero()};
  Eigen::Vector3d h_face{0, 0, 0};
  double cos_i = 0, cos_o = 0;
};

}  // namespace burin
