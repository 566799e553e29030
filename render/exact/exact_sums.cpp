#include "burin/render/exact/exact_sums.h"

namespace burin {
namespace {

// One quantity summed over a pixel's scratches, with its derivatives.
struct Sum {
  double value = 0;
  double depth = 0, width = 0, alpha = 0;  // per unit of the shared parameter
  std::array<Eigen::Vector2d, 4> corner{Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero(),
                                        Eigen::Vector2d::Zero()};
  std::array<double, 6> affine{};
};

void add_gradient(Sum& sum, const PairGradient& g, double scale, const Scratches& s, std::size_t i) {
  for (int k = 0; k < 4; ++k) sum.corner[k] += scale * g.corner[k];
  for (int row = 0; row < 2; ++row) {
    const double g0 = scale * g.p0[row], g1 = scale * g.p1[row];
    sum.affine[3 * row] += g0 * s.x0_mm[i] + g1 * s.x1_mm[i];
    sum.affine[3 * row + 1] += g0 * s.y0_mm[i] + g1 * s.y1_mm[i];
    sum.affine[3 * row + 2] += g0 + g1;
  }
}

}  // namespace

ExactPairs exact_pairs(const ViewScene& scene, const Scratches& scratches, double widest_band_um) {
  const FootprintGrid& grid = *scene.grid;
  const auto strips = strips_of(scratches, scene.tool_width_um, scene.material);
  return {find_pairs(PixelIndex(grid), grid.width(), grid.height(), strips),
          scratch_frames(scratches, scene.tool_width_um, scene.material, widest_band_um)};
}

GrooveSums exact_sums(const ViewScene& scene, const Scratches& scratches, const ExactPairs& of, std::size_t pixel,
                      const PixelShading& p, const std::array<Eigen::Vector2d, 4>& corners_mm, double pixel_area_mm2,
                      bool slopes) {
  const bool own_alpha = !scratches.alpha.empty(), own_depth = !scratches.depth_um.empty(),
             own_width = !scratches.width_um.empty();
  GrooveSums out;
  Sum light, area;
  Shadowing g = shadowing(p.cos_i, p.cos_o, scene.material.alpha);
  for (std::size_t k = of.pairs.begin[pixel]; k < of.pairs.begin[pixel + 1]; ++k) {
    const std::size_t s = of.pairs.scratch[k];
    const ScratchFrame& f = of.frames[s];
    const Quad q = in_scratch(f, corners_mm);
    const Eigen::Vector3d h = in_scratch(f, p.h_face);
    if (!slopes) {
      const FootprintValue value = pair_integral(f, q, h);
      if (own_alpha) g = shadowing(p.cos_i, p.cos_o, f.groove.alpha);
      light.value += g.G * value.Dhat_mm2;
      area.value += value.area_mm2;
      continue;
    }
    const FootprintGradient d = pair_integral_gradient(f, q, h);
    if (d.value.area_mm2 == 0) continue;
    if (own_alpha) g = shadowing(p.cos_i, p.cos_o, f.groove.alpha);
    // A common factor changes each scratch's own value in proportion.
    const double alpha_unit = own_alpha ? f.groove.alpha / scene.material.alpha : 1;
    const double depth_unit = own_depth ? f.groove.depth_um / scene.material.depth_um : 1;
    const double width_unit = own_width ? f.groove.width_um / scene.tool_width_um : 1;
    const PairGradient by_light = to_board(f, q, h, d.dDhat_dcorner, d.dDhat_dhalf, d.dDhat_dlength_mm);
    const PairGradient by_area = to_board(f, q, h, d.darea_dcorner, Eigen::Vector3d::Zero(), d.darea_dlength_mm);
    add_gradient(light, by_light, g.G, scratches, s);
    add_gradient(area, by_area, 1, scratches, s);
    const double Dhat = d.value.Dhat_mm2;
    light.value += g.G * Dhat;
    light.alpha += alpha_unit * (g.G * d.dDhat_dalpha + g.dG_dalpha * Dhat);
    light.depth += depth_unit * g.G * d.dDhat_ddepth_um;
    light.width += width_unit * g.G * d.dDhat_dwidth_um;
    out.h_face += g.G * by_light.h_face;
    out.cos_i += g.dG_dcos_i * Dhat;
    out.cos_o += g.dG_dcos_o * Dhat;
    area.value += d.value.area_mm2;
    area.depth += depth_unit * d.darea_ddepth_um;
    area.width += width_unit * d.darea_dwidth_um;
  }
  const double base = area.value < pixel_area_mm2 ? p.base : 0;
  out.light_mm2 = light.value;
  out.area_mm2 = area.value;
  out.depth_um = light.depth - base * area.depth;
  out.width_um = light.width - base * area.width;
  out.alpha = light.alpha;
  for (int k = 0; k < 6; ++k) out.affine[k] = light.affine[k] - base * area.affine[k];
  for (int k = 0; k < 4; ++k) out.corner_mm[k] = light.corner[k] - base * area.corner[k];
  return out;
}

}  // namespace burin
