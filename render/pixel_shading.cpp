#include "burin/render/pixel_shading.h"

#include <cmath>
#include <numbers>
#include <string>

#include "burin/base/error.h"
#include "burin/render/brdf.h"

namespace burin {

PixelShading shade_pixel(const Eigen::Vector3d& center_mm, const Eigen::Vector3d& normal,
                         const Eigen::Vector3d& camera_center_mm, const Light& light, double base_alpha,
                         const FaceGrain& grain, const Eigen::Vector3d* x_axis) {
  PixelShading p;
  const Eigen::Vector3d to_lamp = light.position_mm - center_mm, to_camera = camera_center_mm - center_mm;
  p.distance_i_mm = to_lamp.norm();
  p.distance_o_mm = to_camera.norm();
  if (!(p.distance_o_mm > 0)) return p;
  p.wo = to_camera / p.distance_o_mm;
  p.cos_o = normal.dot(p.wo);
  p.visible = p.cos_o > 0;
  if (!p.visible || !(p.distance_i_mm > 0)) return p;
  p.wi = to_lamp / p.distance_i_mm;
  p.cos_i = normal.dot(p.wi);
  const double beam = -light.axis.dot(p.wi);
  p.lit = p.cos_i > 0 && (light.falloff_exponent == 0 || beam > 0);
  if (!p.lit) return p;
  p.h = (p.wi + p.wo).normalized();
  const auto in_face = [&](const Eigen::Vector3d& v) -> Eigen::Vector3d {
    if (x_axis == nullptr) return R_face_board(normal) * v;
    return {x_axis->dot(v), normal.cross(*x_axis).dot(v), normal.dot(v)};
  };
  p.h_face = in_face(p.h);
  p.cos_ho = p.h.dot(p.wo);
  p.spot = light.falloff_exponent == 0 ? 1 : std::pow(beam, light.falloff_exponent);
  p.direct = p.spot / (4 * p.cos_o * p.distance_i_mm * p.distance_i_mm);
  if (grain.none()) {
    p.base = ggx_D(p.h_face.z(), base_alpha) * smith_G(p.cos_i, p.cos_o, base_alpha);
    return p;
  }
  p.wi_face = in_face(p.wi);
  p.wo_face = in_face(p.wo);
  const auto G1 = [&](const Eigen::Vector3d& v) {
    return grained_G1(v.x(), v.y(), v.z(), base_alpha, grain.c, grain.s);
  };
  p.base =
      grained_D(p.h_face.x(), p.h_face.y(), p.h_face.z(), base_alpha, grain.c, grain.s) * G1(p.wi_face) * G1(p.wo_face);
  return p;
}

Shadowing shadowing(double cos_i, double cos_o, double alpha) {
  struct One {
    double g, by_alpha, by_cos;
  };
  const auto one = [alpha](double c) {
    const double tan2 = (1 - c * c) / (c * c), root = std::sqrt(1 + alpha * alpha * tan2);
    const double g = 2 / (1 + root), scale = 0.5 * g * g * alpha / root;
    return One{g, -scale * tan2, scale * alpha / (c * c * c)};
  };
  const One i = one(cos_i), o = one(cos_o);
  return {i.g * o.g, i.by_alpha * o.g + i.g * o.by_alpha, i.by_cos * o.g, i.g * o.by_cos};
}

BaseLobe base_lobe(double cos_h, double alpha) {
  const double a2 = alpha * alpha, q = cos_h * cos_h * (a2 - 1) + 1;
  const double D = a2 / (std::numbers::pi * q * q);
  return {D, 2 * alpha / (std::numbers::pi * q * q) * (1 - 2 * a2 * cos_h * cos_h / q), -4 * cos_h * (a2 - 1) * D / q};
}

double base_slope(const PixelShading& pixel, double base_alpha, const FaceGrain& grain) {
  if (!grain.none())
    return grained_lobe(pixel.h_face, pixel.wi_face, pixel.wo_face, base_alpha, grain).by_log_alpha / base_alpha;
  const Shadowing g = shadowing(pixel.cos_i, pixel.cos_o, base_alpha);
  const BaseLobe base = base_lobe(pixel.h_face.z(), base_alpha);
  return base.dD_dalpha * g.G + base.D * g.dG_dalpha;
}

void check_scene_values(const Eigen::Vector3d& camera_center_mm, const Light& light, const Material& material,
                        double tool_width_um, const Eigen::Vector3d& ambient) {
  const auto number = [](bool good, const std::string& name, double value, const char* remedy) {
    if (!good) fail("scene", name + " is " + std::to_string(value), remedy);
  };
  const auto finite = [&](const Eigen::Vector3d& v, const std::string& name) {
    for (int i = 0; i < 3; ++i) number(std::isfinite(v[i]), name, v[i], "it must be a number");
  };
  finite(camera_center_mm, "camera_center_mm");
  finite(light.position_mm, "light.position_mm");
  finite(light.intensity, "light.intensity");
  finite(light.axis, "light.axis");
  finite(material.f0, "material.f0");
  finite(ambient, "ambient");
  number(std::isfinite(light.falloff_exponent) && light.falloff_exponent >= 0, "light.falloff_exponent",
         light.falloff_exponent, "it must be 0 or more");
  const auto roughness = [&](double v, const char* name) {
    number(v > 0 && v <= 1, name, v, "it must be above 0 and at most 1");
  };
  roughness(material.alpha, "material.alpha");
  roughness(material.base_alpha, "material.base_alpha");
  const auto positive = [&](double v, const char* name) {
    number(std::isfinite(v) && v > 0, name, v, "it must be above 0");
  };
  number(std::isfinite(material.grain.c) && std::isfinite(material.grain.s), "material.grain", material.grain.c,
         "its roughnesses must be above 0 and at most 1");
  positive(material.depth_um, "material.depth_um");
  positive(tool_width_um, "tool_width_um");
}

}  // namespace burin
