// burin/calib/light/lamp_model.h - light of paper and plain face under a lamp, over any scalar type: Ceres' and double.
// docs/model.md 5. Frame: board, mm.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <numbers>
#include <span>

#include "burin/calib/light/light_samples.h"
#include "burin/render/brdf.h"
#include "burin/render/pixel_shading.h"
#include "burin/scene/board.h"
#include "burin/scene/face_grain.h"
#include "burin/scene/lamp_size.h"

namespace burin {

/// True if a lamp's area is too small to change derivatives of glints by more than half a percent. `reach_mm` is the
/// area's reach from its middle. The change is the curvature of a lobe, 4 / alpha^2, times half the variance of half
/// vectors.
inline bool is_small_lamp(double reach_mm, double distance_mm, double roughness) {
  constexpr double kOfRoughness = 0.1;
  return 0.5 * reach_mm < kOfRoughness * roughness * distance_mm;
}

/// A lamp in the fits. A spotlight's axis points from the lamp at `aim` on the plane z = 0 of the board, so it always
/// points at the board's side. Exponent 0 is a bare lamp; then `aim` has no meaning.
template <typename T>
struct LampModel {
  Eigen::Matrix<T, 3, 1> position_mm;
  T log_intensity;
  Eigen::Matrix<T, 2, 1> aim_mm;
  T exponent;
  /// Offset of a point of an area light from its middle, the origin of the axis.
  Eigen::Matrix<T, 3, 1> offset_mm = Eigen::Matrix<T, 3, 1>::Zero();
};

/// Exponent of an area light whose falloff no data constrain: a plane with equal radiance in all directions; and its
/// sigma.
inline constexpr double kPlaneExponent = 1, kPlaneExponentSigma = 0.5;

/// Lower bound of base_alpha in fits. Mirrors have less than 0.001. Photos away from their highlight show only a dark
/// face. With a larger bound, fits would turn lamps away from the face.
inline constexpr double kSmoothestFace = 1e-4;

/// Albedo of a tag's white or black paper, from board.json.
inline double paper_albedo(const Board& board, SampleKind kind) {
  return kind == SampleKind::white_paper ? board.tags.white_albedo : board.tags.black_albedo;
}

/// Irradiance factor at a point: (axis . -wi)^k / d^2, times exp(log_intensity). Puts out wi, the unit vector from the
/// point towards the lamp.
template <typename T>
T lamp_irradiance(const LampModel<T>& lamp, const Eigen::Vector3d& p_board, Eigen::Matrix<T, 3, 1>& wi) {
  using std::exp;
  using std::pow;
  const Eigen::Matrix<T, 3, 1> to_lamp = lamp.position_mm - (p_board.template cast<T>() - lamp.offset_mm);
  const T distance2 = to_lamp.squaredNorm();
  wi = to_lamp / sqrt(distance2);
  T value = exp(lamp.log_intensity) / distance2;
  if (lamp.exponent > T(0)) {
    const Eigen::Matrix<T, 3, 1> axis =
        (Eigen::Matrix<T, 3, 1>(lamp.aim_mm.x(), lamp.aim_mm.y(), T(0)) - lamp.position_mm).normalized();
    const T cosine = -axis.dot(wi);
    value *= cosine > T(1e-6) ? T(pow(cosine, lamp.exponent)) : T(pow(T(1e-6), lamp.exponent));
  }
  return value;
}

/// PaperCoat in the fits.
template <typename T>
struct PaperGloss {
  T f0 = T(0), alpha = T(0.3);
};

/// Radiance of paper: albedo / pi cos I / d^2 + albedo * ambient * sample.around (Lambertian), plus its coat's
/// reflection (model.md 5.14). An area light is the mean over `points` (lamp_points()); without them the lamp is a
/// point.
template <typename T>
T paper_radiance(const LampModel<T>& lamp, const T& ambient, double albedo, const LightSample& sample,
                 std::span<const LampPoint> points = {}, const PaperGloss<T>& gloss = {}) {
  const auto lit_by = [&](const LampModel<T>& point) {
    Eigen::Matrix<T, 3, 1> wi;
    const T irradiance = lamp_irradiance(point, sample.p_board, wi);
    const Eigen::Matrix<T, 3, 1> n = sample.normal.cast<T>();
    const T cosine = wi.dot(n);
    if (!(cosine > T(0))) return T(0);
    T sent = albedo / std::numbers::pi * cosine;
    if (gloss.f0 > T(0)) {
      const Eigen::Matrix<T, 3, 1> wo = sample.to_camera.cast<T>(), h = (wi + wo).normalized();
      const T cos_o = wo.dot(n);
      sent += ggx_D(T(h.dot(n)), gloss.alpha) * smith_G(cosine, cos_o, gloss.alpha) *
              schlick_F(T(h.dot(wo)), gloss.f0) / (4. * cos_o);
    }
    return T(sent * irradiance);
  };
  T lit(0);
  for (const LampPoint& point : points) {
    LampModel<T> at = lamp;
    at.offset_mm = point.offset_mm.template cast<T>();
    lit += point.share * lit_by(at);
  }
  if (points.empty()) lit = lit_by(lamp);
  return (albedo + gloss.f0) * ambient * sample.around + lit;
}

/// Radiance of the face between scratches: D G F / (4 wo.z) I / d^2 + F0 * ambient * sample.around, all with
/// base_alpha. `f0` is the mean of the channels; `grain` holds FaceGrain's c and s.
template <typename T>
T face_radiance(const LampModel<T>& lamp, const T& ambient, const T& base_alpha, const T* grain, double f0,
                const LightSample& sample) {
  Eigen::Matrix<T, 3, 1> wi;
  const T irradiance = lamp_irradiance(lamp, sample.p_board, wi);
  const Eigen::Matrix<T, 3, 1> wo = sample.to_camera.cast<T>(), n = sample.normal.cast<T>();
  const Eigen::Matrix<T, 3, 1> h = (wi + wo).normalized();
  const T cos_o = wo.dot(n);
  const T around = schlick_F(T(h.dot(wo)), T(f0)) / (4. * cos_o);
  if (grain[0] == T(0) && grain[1] == T(0)) {
    const T lobe = ggx_D(T(h.dot(n)), base_alpha) * smith_G(T(wi.dot(n)), cos_o, base_alpha);
    return lobe * around * irradiance + f0 * sample.around * ambient;
  }
  const Eigen::Matrix<T, 3, 3> R = R_face_board(sample.normal).cast<T>();
  const Eigen::Matrix<T, 3, 1> h_face = R * h, i_face = R * wi, o_face = R * wo;
  const T lobe = grained_D(h_face.x(), h_face.y(), h_face.z(), base_alpha, grain[0], grain[1]) *
                 grained_G1(i_face.x(), i_face.y(), i_face.z(), base_alpha, grain[0], grain[1]) *
                 grained_G1(o_face.x(), o_face.y(), o_face.z(), base_alpha, grain[0], grain[1]);
  return lobe * around * irradiance + f0 * sample.around * ambient;
}

/// Prior of v1, v2, v3: lenses darken mostly as r^2, and photos hardly separate the higher orders.
inline constexpr std::array<double, 3> kVignettePriorSigma{0.5, 0.25, 0.1};

}  // namespace burin
