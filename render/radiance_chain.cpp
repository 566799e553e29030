#include "burin/render/radiance_chain.h"

#include <algorithm>
#include <cmath>

#include "burin/render/exact/exact_view.h"

namespace burin {
namespace {

double& of(BySceneParameter& v, SceneParameter p, int offset = 0) { return v[static_cast<int>(p) + offset]; }

/// Derivatives of D G of the plain face: by_cos_i and by_cos_o without a grain, by_wi and by_wo (frame of the face)
/// with one.
struct BaseSlopes {
  double by_alpha = 0, by_c = 0, by_s = 0, by_cos_i = 0, by_cos_o = 0;
  Eigen::Vector3d by_h{0, 0, 0}, by_wi{0, 0, 0}, by_wo{0, 0, 0};
};
/// `by_grain`: derivatives by c and s also for a face without grain.
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

}  // namespace

// Derivatives of one channel's radiance by the pixel's geometry.
struct RadianceChain::GeometryGradient {
  Eigen::Vector3d light{0, 0, 0}, axis{0, 0, 0}, camera{0, 0, 0}, center{0, 0, 0}, normal{0, 0, 0};
  std::array<Eigen::Vector2d, 4> corner;
};

RadianceChain::RadianceChain(const ViewScene& of_scene, const CameraView& of_camera, bool with_grain)
    : scene(of_scene),
      camera(of_camera),
      R_camera_board(of_camera.T_camera_board.linear()),
      by_grain(with_grain),
      cylinder(of_camera.surface.bend ? std::optional(cylinder_of(of_camera.surface)) : std::nullopt) {}

void RadianceChain::run(const ChainedPixel& pixel, const GrooveSums& sums, double factor, double factor_slope,
                        BySceneParameter& out) const {
  const PixelShading& p = pixel.shading;
  const Eigen::Vector3d &normal = pixel.normal, &center = pixel.center_mm;
  const std::array<Eigen::Vector2d, 4>& corners = pixel.corners_mm;
  const double A = pixel.area_mm2;
  const BaseSlopes base = base_slopes(p, normal, scene.material, by_grain);
  const double covered = std::min(1.0, sums.area_mm2 / A), plain = 1 - covered;
  const double clamp = sums.area_mm2 < A ? 1 : 0;  // derivative of the active side
  const double scale = factor * p.direct;
  const double Q = p.direct * (sums.light_mm2 / A + plain * p.base);

  of(out, SceneParameter::alpha) = scale / A * sums.alpha;
  of(out, SceneParameter::depth_um) = scale / A * sums.depth_um;
  of(out, SceneParameter::width_um) = scale / A * sums.width_um;
  of(out, SceneParameter::base_alpha) = scale * plain * base.by_alpha;
  of(out, SceneParameter::grain_c) = scale * plain * base.by_c;
  of(out, SceneParameter::grain_s) = scale * plain * base.by_s;
  of(out, SceneParameter::log_intensity) = factor * Q;
  for (int k = 0; k < 6; ++k) of(out, SceneParameter::machine_00, k) = scale / A * sums.affine[k];

  // Backward from Q and F through half vector and cosines to positions. by_x is d radiance / d x.
  Eigen::Vector3d by_h_face = scale / A * sums.h_face;
  by_h_face += scale * plain * base.by_h;
  const double by_cos_i = scale * (sums.cos_i / A + plain * base.by_cos_i);
  const double by_cos_o = scale * (sums.cos_o / A + plain * base.by_cos_o) - factor * Q / p.cos_o;
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
  const double by_A = -scale * (sums.light_mm2 - clamp * p.base * sums.area_mm2) / (A * A);
  for (int k = 0; k < 4; ++k) g.corner[k] = scale / A * sums.corner_mm[k] + by_A * dA[k];
  chain_geometry(g, center, corners, out);
}

void RadianceChain::chain_geometry(const GeometryGradient& g, const Eigen::Vector3d& center,
                                   const std::array<Eigen::Vector2d, 4>& corners, BySceneParameter& out) const {
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

  // A corner slides along the face so that its ray stays fixed in the camera. With v the ray from the camera to it and
  // n the face's normal, a motion u of the camera's frame moves it by v (n.u) / (n.v) - u.
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

// chain_geometry() on a bent sheet. `across` and `along` are positions on the sheet, where flat lengths are preserved.
void RadianceChain::chain_bent(const GeometryGradient& g, const std::array<Eigen::Vector2d, 4>& corners,
                               BySceneParameter& out) const {
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

void RadianceChain::set_pose_and_bow(const GeometryGradient& g, const Eigen::Vector3d& push,
                                     const Eigen::Vector3d& turn, const Eigen::Vector3d& by_bow,
                                     BySceneParameter& out) const {
  const Eigen::Vector3d by_t = -(R_camera_board * (push + g.camera)), by_r = -(R_camera_board * turn);
  for (int k = 0; k < 3; ++k) {
    of(out, SceneParameter::pose_rx, k) = by_r[k];
    of(out, SceneParameter::pose_tx_mm, k) = by_t[k];
    of(out, SceneParameter::bow_0_mm, k) = by_bow[k];
  }
}

}  // namespace burin
