#include "burin/render/fast/pixel_slopes.h"

#include <Eigen/LU>

namespace burin {

GrooveSums groove_sums(const PixelSlopes& slopes, double unit, const PixelShading& p,
                       const std::array<Eigen::Vector2d, 4>& corners_mm, double area_mm2, double alpha) {
  const auto by_number = [&](int number) { return unit * slopes.by[number]; };
  GrooveSums out;
  out.light_mm2 = unit * slopes.light;
  out.area_mm2 = slopes.area_mm2;
  out.depth_um = by_number(kByDepth);
  out.width_um = by_number(kByWidth);
  out.alpha = by_number(kByAlpha);
  out.h_face = {by_number(kByHalf), by_number(kByHalf + 1), 0};
  const Shadowing g = shadowing(p.cos_i, p.cos_o, alpha);
  out.cos_i = out.light_mm2 * g.dG_dcos_i / g.G;
  out.cos_o = out.light_mm2 * g.dG_dcos_o / g.G;

  const Eigen::Vector2d middle = 0.25 * (corners_mm[0] + corners_mm[1] + corners_mm[2] + corners_mm[3]),
                        shift(by_number(kByShift), by_number(kByShift + 1));
  for (int row = 0; row < 2; ++row) {
    for (int k = 0; k < 2; ++k) out.affine[3 * row + k] = shift[row] * middle[k] + by_number(kByGrooves + 2 * row + k);
    out.affine[3 * row + 2] = shift[row];
  }

  // The corners follow a linear map; each corner has its share of the map's derivative.
  const double base = slopes.area_mm2 < area_mm2 ? p.base : 0;
  Eigen::Matrix2d by_map = (out.light_mm2 - base * out.area_mm2) * Eigen::Matrix2d::Identity(),
                  spread = Eigen::Matrix2d::Zero();
  for (int k = 0; k < 4; ++k) by_map(k / 2, k % 2) += by_number(kByFootprint + k);
  for (const Eigen::Vector2d& corner : corners_mm) spread += (corner - middle) * (corner - middle).transpose();
  const Eigen::Matrix2d by_place = by_map * spread.inverse();
  for (int k = 0; k < 4; ++k) out.corner_mm[k] = by_place * (corners_mm[k] - middle) - 0.25 * shift;
  return out;
}

}  // namespace burin
