// burin/render/groove_sums.h - sums over the grooves of one pixel, with their derivatives by all parameters of a photo.
// exact/exact_sums.h computes them pair by pair in double, fast/pixel_slopes.h in float SIMD vectors. radiance_chain.h
// chains them to the bench's parameters. docs/model.md 5.
#pragma once

#include <Eigen/Core>
#include <array>

namespace burin {

struct GrooveSums {
  double light_mm2 = 0;  ///< sum of Dhat G
  double area_mm2 = 0;   ///< covered area, not clamped
  // Derivatives of light - base * area. The second term is the plain face's light under the grooves; it is absent if
  // they cover the whole pixel. Derivatives are by the shared parameters, the machine's affine map and the pixel's
  // geometry.
  double depth_um = 0, width_um = 0, alpha = 0;
  std::array<double, 6> affine{};
  std::array<Eigen::Vector2d, 4> corner_mm{Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero(),
                                           Eigen::Vector2d::Zero()};
  Eigen::Vector3d h_face{0, 0, 0};
  double cos_i = 0, cos_o = 0;
};

}  // namespace burin
