// render_with_derivatives(): radiance and its derivatives by everything that a photo can tell about. docs/model.md 5.
//
// Forward over the scratches, backward over the pixel. Each pixel sums over its pairs what Dhat G and the covered area
// do when its half vector, its cosines, its footprint's corners, the material or the machine's affine change. What a
// lamp, a pose or a bow does to those is then chained back through the pixel's geometry, once a pixel, however many
// pairs it has. Pairs are grouped by pixel, so nothing depends on the number of threads.
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "burin/render/error.h"
#include "burin/render/exact/exact_view.h"
#include "burin/render/exact/scratch_pair.h"
#include "burin/render/fast/pairs.h"
#include "burin/render/parts_derivatives.h"
#include "burin/render/pixel_shading.h"
#include "burin/render/view_renderer.h"

namespace burin {
namespace {

constexpr int kParameters = static_cast<int>(SceneParameter::grain_s) + 1;
using ByParameter = std::array<double, kParameters>;

double& of(ByParameter& v, SceneParameter p, int offset = 0) { return v[static_cast<int>(p) + offset]; }

/// One quantity summed over a pixel's scratches, with what it depends on.
struct Sum {
  double value = 0;
  double depth = 0, width = 0, alpha = 0;  // per unit of the shared parameter
  std::array<Eigen::Vector2d, 4> corner{Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero(),
                                        Eigen::Vector2d::Zero()};
  std::array<double, 6> affine{};
};

struct PixelSums {
  Sum light;  // Dhat G, mm^2
  Sum area;   // mm^2
  Eigen::Vector3d light_by_h_face{0, 0, 0};
  double light_by_cos_i = 0, light_by_cos_o = 0;
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

/// D G of the plain face by everything: by_cos_i and by_cos_o without a grain, by_wi and by_wo (frame of the face) with
/// one.
struct BaseSlopes {
  double by_alpha = 0, by_c = 0, by_s = 0, by_cos_i = 0, by_cos_o = 0;
  Eigen::Vector3d by_h{0, 0, 0}, by_wi{0, 0, 0}, by_wo{0, 0, 0};
};
/// `by_grain`: by c and s too where there is no grain.
BaseSlopes base_slopes(const PixelShading& p, const Eigen::Vector3d& normal, const Material& material, bool by_grain) {
  BaseSlopes out;
  const double alpha = material.base_alpha;
  if (material.grain.none()) {
    const Shadowing G = shadowing(p.cos_i, p.cos_o, alpha);
    const BaseLobe D = base_lobe(p.h_face.z(), alpha);
    out.by_alpha = D.dD_dalpha * G.G + D.D * G.dG_dalpha;
    out.by_cos_i = D.D * G.dG_dcos_i;
    out.by_cos_o = D.D * G.dG_dcos_o;
    out.by_h.z() = D.dD_dcos_h * G.G;
    if (!by_grain) return out;
    const Eigen::Matrix3d R = R_face_board(normal);
    const GrainedLobe lobe = grained_lobe(p.h_face, R * p.wi, R * p.wo, alpha, {});
    out.by_c = lobe.by_c;
    out.by_s = lobe.by_s;
    return out;
  }
  const GrainedLobe lobe = grained_lobe(p.h_face, p.wi_face, p.wo_face, alpha, material.grain);
  out.by_alpha = lobe.by_log_alpha / alpha;
  out.by_c = lobe.by_c;
  out.by_s = lobe.by_s;
  out.by_h = lobe.by_h;
  out.by_wi = lobe.by_wi;
  out.by_wo = lobe.by_wo;
  return out;
}

/// d/d(normal) of a quantity that depends by `by_face` on R_face_board(normal) v.
Eigen::Vector3d turned_with_face(const Eigen::Vector3d& normal, const Eigen::Vector3d& v,
                                 const Eigen::Vector3d& by_face) {
  const Eigen::Vector3d m = normal + Eigen::Vector3d::UnitZ();
  const double fold = 1 + normal.z(), vm = v.dot(m), gm = by_face.dot(m);
  Eigen::Vector3d out = -(v * gm + by_face * vm) / fold + 2 * by_face.z() * v;
  out.z() += vm * gm / (fold * fold);
  return out;
}

/// How one channel's radiance answers to the pixel's geometry.
struct GeometryGradient {
  Eigen::Vector3d light{0, 0, 0}, axis{0, 0, 0}, camera{0, 0, 0}, center{0, 0, 0}, normal{0, 0, 0};
  std::array<Eigen::Vector2d, 4> corner;
};

/// Everything of one view that the chain needs at each pixel.
struct Chain {
  const ViewScene& scene;
  const CameraView& camera;
  Eigen::Matrix3d R_camera_board;
  bool by_grain;                     ///< is asked for
  std::optional<Cylinder> cylinder;  ///< of a bent sheet

  /// Q = direct (light / A + (1 - covered) base), radiance = factor(cos_ho) Q + ambient. Derivatives of one channel.
  void run(const PixelShading& p, const Eigen::Vector3d& normal, const Eigen::Vector3d& center,
           const std::array<Eigen::Vector2d, 4>& corners, double footprint_mm2, const PixelSums& sums, double factor,
           double factor_slope, ByParameter& out) const;

 private:
  void chain_geometry(const GeometryGradient& g, const Eigen::Vector3d& center,
                      const std::array<Eigen::Vector2d, 4>& corners, ByParameter& out) const;
  void chain_bent(const GeometryGradient& g, const std::array<Eigen::Vector2d, 4>& corners, ByParameter& out) const;
  void set_pose_and_bow(const GeometryGradient& g, const Eigen::Vector3d& push, const Eigen::Vector3d& turn,
                        const Eigen::Vector3d& by_bow, ByParameter& out) const;
};

void Chain::run(const PixelShading& p, const Eigen::Vector3d& normal, const Eigen::Vector3d& center,
                const std::array<Eigen::Vector2d, 4>& corners, double A, const PixelSums& sums, double factor,
                double factor_slope, ByParameter& out) const {
  const BaseSlopes base = base_slopes(p, normal, scene.material, by_grain);
  const double covered = std::min(1.0, sums.area.value / A), plain = 1 - covered;
  const double clamp = sums.area.value < A ? 1 : 0;  // the side it is on
  const double scale = factor * p.direct;
  const double Q = p.direct * (sums.light.value / A + plain * p.base);

  const auto lobes = [&](double d_light, double d_area) { return scale * (d_light - clamp * p.base * d_area) / A; };
  of(out, SceneParameter::alpha) = lobes(sums.light.alpha, 0);
  of(out, SceneParameter::depth_um) = lobes(sums.light.depth, sums.area.depth);
  of(out, SceneParameter::width_um) = lobes(sums.light.width, sums.area.width);
  of(out, SceneParameter::base_alpha) = scale * plain * base.by_alpha;
  of(out, SceneParameter::grain_c) = scale * plain * base.by_c;
  of(out, SceneParameter::grain_s) = scale * plain * base.by_s;
  of(out, SceneParameter::log_intensity) = factor * Q;
  for (int k = 0; k < 6; ++k) of(out, SceneParameter::machine_00, k) = lobes(sums.light.affine[k], sums.area.affine[k]);

  // Backward from Q and F through half vector and cosines to places. by_x is d radiance / d x.
  Eigen::Vector3d by_h_face = scale / A * sums.light_by_h_face;
  by_h_face += scale * plain * base.by_h;
  const double by_cos_i = scale * (sums.light_by_cos_i / A + plain * base.by_cos_i);
  const double by_cos_o = scale * (sums.light_by_cos_o / A + plain * base.by_cos_o) - factor * Q / p.cos_o;
  const double by_cos_ho = factor_slope * Q;

  GeometryGradient g;
  const Eigen::Vector3d by_h = R_face_board(normal).transpose() * by_h_face + by_cos_ho * p.wo;
  g.normal = p.wi * by_cos_i + p.wo * by_cos_o + turned_with_face(normal, p.h, by_h_face);
  const Eigen::Vector3d by_sum = (by_h - p.h * p.h.dot(by_h)) / (p.wi + p.wo).norm();
  Eigen::Vector3d by_wi = by_sum + normal * by_cos_i;
  Eigen::Vector3d by_wo = by_sum + normal * by_cos_o + by_cos_ho * p.h;
  if (!scene.material.grain.none()) {
    const Eigen::Matrix3d R = R_face_board(normal);
    const Eigen::Vector3d by_wi_face = scale * plain * base.by_wi, by_wo_face = scale * plain * base.by_wo;
    by_wi += R.transpose() * by_wi_face;
    by_wo += R.transpose() * by_wo_face;
    g.normal += turned_with_face(normal, p.wi, by_wi_face) + turned_with_face(normal, p.wo, by_wo_face);
  }

  const Light& lamp = scene.light;
  if (lamp.falloff_exponent != 0) {
    const double beam = -lamp.axis.dot(p.wi), by_beam = factor * Q * lamp.falloff_exponent / beam;
    by_wi -= lamp.axis * by_beam;
    g.axis = -p.wi * by_beam;
  }
  const double beam = -lamp.axis.dot(p.wi);
  of(out, SceneParameter::falloff_exponent) = beam > 0 ? factor * Q * std::log(beam) : 0;
  g.light = (by_wi - p.wi * p.wi.dot(by_wi)) / p.distance_i_mm - 2 * factor * Q / p.distance_i_mm * p.wi;
  g.camera = (by_wo - p.wo * p.wo.dot(by_wo)) / p.distance_o_mm;
  g.center = -g.light - g.camera;

  // Area of the footprint by its corners: half the cross product of its diagonals.
  const Eigen::Vector2d a = corners[2] - corners[0], b = corners[3] - corners[1];
  const double half = a.x() * b.y() - a.y() * b.x() < 0 ? -0.5 : 0.5;
  const Eigen::Vector2d by2 = half * Eigen::Vector2d(b.y(), -b.x()), by3 = half * Eigen::Vector2d(-a.y(), a.x());
  const std::array<Eigen::Vector2d, 4> dA{-by2, -by3, by2, by3};
  const double by_A = -scale * (sums.light.value - clamp * p.base * sums.area.value) / (A * A);
  for (int k = 0; k < 4; ++k)
    g.corner[k] = scale / A * (sums.light.corner[k] - clamp * p.base * sums.area.corner[k]) + by_A * dA[k];
  chain_geometry(g, center, corners, out);
}

void Chain::chain_geometry(const GeometryGradient& g, const Eigen::Vector3d& center,
                           const std::array<Eigen::Vector2d, 4>& corners, ByParameter& out) const {
  for (int k = 0; k < 3; ++k) {
    of(out, SceneParameter::light_x_mm, k) = g.light[k];
    of(out, SceneParameter::light_axis_x, k) = g.axis[k];
  }
  const Surface& face = camera.surface;
  if (face.bend) {
    chain_bent(g, corners, out);
    return;
  }
  const double sx = face.size_mm.x(), sy = face.size_mm.y();
  const auto XY = [&](double x, double y) { return Eigen::Vector2d(2 * x / sx - 1, 2 * y / sy - 1); };
  const auto bow_terms = [](const Eigen::Vector2d& q) {
    return Eigen::Vector3d(q.x() * q.x(), q.x() * q.y(), q.y() * q.y());
  };
  const auto slopes = [&](const Eigen::Vector2d& q) {
    return Eigen::Vector2d((2 * face.bow_mm[0] * q.x() + face.bow_mm[1] * q.y()) * 2 / sx,
                           (face.bow_mm[1] * q.x() + 2 * face.bow_mm[2] * q.y()) * 2 / sy);
  };

  // The center stays on the face over the mean of the corners; its normal follows.
  const Eigen::Vector2d q = XY(center.x(), center.y()), slope = slopes(q);
  Eigen::Vector2d by_center_xy = g.center.head<2>() + slope * g.center.z();
  Eigen::Vector3d by_bow = bow_terms(q) * g.center.z();
  {
    const Eigen::Vector3d m(-slope.x(), -slope.y(), 1);
    const double length = m.norm();
    const Eigen::Vector3d n = m / length, by_m = (g.normal - n * n.dot(g.normal)) / length;
    const double by_zx = -by_m.x(), by_zy = -by_m.y();
    const double zxx = 8 * face.bow_mm[0] / (sx * sx), zxy = 4 * face.bow_mm[1] / (sx * sy),
                 zyy = 8 * face.bow_mm[2] / (sy * sy);
    by_center_xy += Eigen::Vector2d(zxx * by_zx + zxy * by_zy, zxy * by_zx + zyy * by_zy);
    by_bow += Eigen::Vector3d(4 * q.x() / sx * by_zx, 2 * q.y() / sx * by_zx + 2 * q.x() / sy * by_zy,
                              4 * q.y() / sy * by_zy);
  }

  // A corner slides along the face so that its ray stays where it is in the camera: with v the ray from the camera to
  // it and n the face's normal, a motion u of the camera's frame moves it by v (n.u) / (n.v) - u.
  Eigen::Vector3d push = Eigen::Vector3d::Zero(), turn = Eigen::Vector3d::Zero();
  for (int k = 0; k < 4; ++k) {
    const Eigen::Vector2d by = g.corner[k] + 0.25 * by_center_xy, at = XY(corners[k].x(), corners[k].y());
    const Eigen::Vector2d z = slopes(at);
    const Eigen::Vector3d n(-z.x(), -z.y(), 1);
    const Eigen::Vector3d v =
        Eigen::Vector3d(corners[k].x(), corners[k].y(), face.bow_mm.dot(bow_terms(at))) - scene.camera_center_mm;
    const double along = by.dot(v.head<2>()) / n.dot(v);
    const Eigen::Vector3d k3 = Eigen::Vector3d(by.x(), by.y(), 0) - n * along;
    push += k3;
    turn += v.cross(k3);
    by_bow += bow_terms(at) * along;
  }
  set_pose_and_bow(g, push, turn, by_bow, out);
}

// The same on a bent sheet, whose places move along it by `across` and `along`: flat lengths are lengths there.
void Chain::chain_bent(const GeometryGradient& g, const std::array<Eigen::Vector2d, 4>& corners,
                       ByParameter& out) const {
  const Cylinder& sheet = *cylinder;
  const Eigen::Vector2d middle = 0.25 * (corners[0] + corners[1] + corners[2] + corners[3]);
  const BentPlace at = bent_place(sheet, middle);
  const BentMotion moves = bent_motion(sheet, middle);
  const double by_across = at.across.dot(g.center) + sheet.curvature * at.across.dot(g.normal),
               by_along = at.along.dot(g.center);
  const Eigen::Vector2d by_middle = by_across * sheet.across + by_along * sheet.along;
  Eigen::Vector3d by_bow = Eigen::Vector3d::Zero(), push = by_bow, turn = by_bow;
  for (int i = 0; i < 2; ++i) by_bow[i] = moves.position_by[i].dot(g.center) + moves.normal_by[i].dot(g.normal);
  for (int k = 0; k < 4; ++k) {
    const Eigen::Vector2d by = g.corner[k] + 0.25 * by_middle;
    const BentPlace corner = bent_place(sheet, corners[k]);
    const BentMotion corner_moves = bent_motion(sheet, corners[k]);
    const Eigen::Vector3d by_place = sheet.across.dot(by) * corner.across + sheet.along.dot(by) * corner.along;
    const Eigen::Vector3d v = corner.position_mm - scene.camera_center_mm;
    const double along = by_place.dot(v) / corner.normal.dot(v);
    const Eigen::Vector3d k3 = by_place - corner.normal * along;
    push += k3;
    turn += v.cross(k3);
    for (int i = 0; i < 2; ++i) by_bow[i] -= corner_moves.position_by[i].dot(k3);
  }
  set_pose_and_bow(g, push, turn, by_bow, out);
}

void Chain::set_pose_and_bow(const GeometryGradient& g, const Eigen::Vector3d& push, const Eigen::Vector3d& turn,
                             const Eigen::Vector3d& by_bow, ByParameter& out) const {
  const Eigen::Vector3d by_t = -(R_camera_board * (push + g.camera)), by_r = -(R_camera_board * turn);
  for (int k = 0; k < 3; ++k) {
    of(out, SceneParameter::pose_rx, k) = by_r[k];
    of(out, SceneParameter::pose_tx_mm, k) = by_t[k];
    of(out, SceneParameter::bow_0_mm, k) = by_bow[k];
  }
}

}  // namespace

RadianceDerivatives render_with_derivatives(const ViewScene& scene, const CameraView& camera, const Carved& carved,
                                            std::span<const SceneParameter> parameters, const RenderOptions& options) {
  if (!scene.light.size.is_point())
    return mean_with_derivatives(scene_parts(scene), camera, carved, parameters, options);
  const Scratches& scratches = carved.scratches;
  check_scratches(scratches);
  const int channels = options.channels;
  const ViewPixels pixels = view_pixels(scene, channels);
  const FootprintGrid& grid = *scene.grid;
  const auto strips = strips_of(scratches, scene.tool_width_um, scene.material);
  const PixelPairs pairs = find_pairs(PixelIndex(grid), grid.width(), grid.height(), strips);
  const std::vector<ScratchFrame> frames = scratch_frames(scratches, scene.tool_width_um, scene.material);
  const bool own_alpha = !scratches.alpha.empty(), own_depth = !scratches.depth_um.empty(),
             own_width = !scratches.width_um.empty();

  RadianceDerivatives result;
  result.radiance = Image(grid.width(), grid.height(), channels);
  result.d_radiance.assign(parameters.size(), Image(grid.width(), grid.height(), channels));
  const std::array<double, 3> ambient = ambient_radiance(scene, channels);
  const bool by_grain = std::any_of(parameters.begin(), parameters.end(), [](SceneParameter p) {
    return p == SceneParameter::grain_c || p == SceneParameter::grain_s;
  });
  const Chain chain{scene, camera, camera.T_camera_board.linear(), by_grain,
                    camera.surface.bend ? std::optional(cylinder_of(camera.surface)) : std::nullopt};

  const auto sum_pixel = [&](std::size_t i, const PixelShading& p, const std::array<Eigen::Vector2d, 4>& corners) {
    PixelSums sums;
    Shadowing g = shadowing(p.cos_i, p.cos_o, scene.material.alpha);
    for (std::size_t k = pairs.begin[i]; k < pairs.begin[i + 1]; ++k) {
      const std::size_t s = pairs.scratch[k];
      const ScratchFrame& f = frames[s];
      const Quad q = in_scratch(f, corners);
      const Eigen::Vector3d h = in_scratch(f, p.h_face);
      if (parameters.empty()) {
        const FootprintValue value = pair_integral(f, q, h);
        if (own_alpha) g = shadowing(p.cos_i, p.cos_o, f.groove.alpha);
        sums.light.value += g.G * value.Dhat_mm2;
        sums.area.value += value.area_mm2;
        continue;
      }
      const FootprintGradient d = pair_integral_gradient(f, q, h);
      if (d.value.area_mm2 == 0) continue;
      if (own_alpha) g = shadowing(p.cos_i, p.cos_o, f.groove.alpha);
      // A common factor's change moves each scratch's own value in proportion.
      const double alpha_unit = own_alpha ? f.groove.alpha / scene.material.alpha : 1;
      const double depth_unit = own_depth ? f.groove.depth_um / scene.material.depth_um : 1;
      const double width_unit = own_width ? f.groove.width_um / scene.tool_width_um : 1;
      const PairGradient light = to_board(f, q, h, d.dDhat_dcorner, d.dDhat_dhalf, d.dDhat_dlength_mm);
      const PairGradient area = to_board(f, q, h, d.darea_dcorner, Eigen::Vector3d::Zero(), d.darea_dlength_mm);
      add_gradient(sums.light, light, g.G, scratches, s);
      add_gradient(sums.area, area, 1, scratches, s);
      const double Dhat = d.value.Dhat_mm2;
      sums.light.value += g.G * Dhat;
      sums.light.alpha += alpha_unit * (g.G * d.dDhat_dalpha + g.dG_dalpha * Dhat);
      sums.light.depth += depth_unit * g.G * d.dDhat_ddepth_um;
      sums.light.width += width_unit * g.G * d.dDhat_dwidth_um;
      sums.light_by_h_face += g.G * light.h_face;
      sums.light_by_cos_i += g.dG_dcos_i * Dhat;
      sums.light_by_cos_o += g.dG_dcos_o * Dhat;
      sums.area.value += d.value.area_mm2;
      sums.area.depth += depth_unit * d.darea_ddepth_um;
      sums.area.width += width_unit * d.darea_dwidth_um;
    }
    return sums;
  };

  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, pixels.size(), 256), [&](const tbb::blocked_range<std::size_t>& range) {
        for (std::size_t i = range.begin(); i < range.end(); ++i) {
          const PixelShading& p = pixels.shading[i];
          const double area = pixels.area_mm2[i];
          if (!(area > 0) || !p.visible) continue;
          for (int c = 0; c < channels; ++c) result.radiance.data[i * channels + c] = static_cast<float>(ambient[c]);
          if (!p.lit) continue;
          const auto corners =
              footprint_corners_mm(grid, static_cast<int>(i % grid.width()), static_cast<int>(i / grid.width()));
          const PixelSums sums = sum_pixel(i, p, corners);
          const double Q = p.direct * (sums.light.value / area + (1 - std::min(1.0, sums.area.value / area)) * p.base);
          const auto factor = channel_factors(scene, p.cos_ho, channels);
          const auto slope = channel_factor_slopes(scene, p.cos_ho, channels);
          for (int c = 0; c < channels; ++c) {
            const std::size_t at = i * channels + c;
            result.radiance.data[at] = static_cast<float>(factor[c] * Q + ambient[c]);
            if (parameters.empty()) continue;
            ByParameter by{};
            chain.run(p, grid.normal[i], grid.center_mm[i], corners, area, sums, factor[c], slope[c], by);
            for (std::size_t k = 0; k < parameters.size(); ++k)
              result.d_radiance[k].data[at] = static_cast<float>(by[static_cast<int>(parameters[k])]);
          }
        }
      });
  return result;
}

}  // namespace burin
