// burin/calib/light/lamp.h - where the lamp is, from the brightness of paper and of the plain face. docs/model.md 5 and
// 9 'Lamp'. Frame: board, mm. Intensities are with Sensor::gain = 1, the mean of the photo's channels.
//
// Two of the lamp's three cues, which need no scratch: the shading of the tags' white and black paper (cosine and
// distance: where the lamp is within some 30-100 mm, its intensity, the ambient light) and the mirror highlight of the
// plain face (its lobe around the lamp's mirror image: the lamp's direction, base_alpha). What they give is a seed; the
// third cue, the glints of scratches, joins in burin/calib/refine.h, where everything is fitted to every pixel.
#pragma once

#include <Eigen/Core>
#include <array>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "burin/calib/light/light_samples.h"
#include "burin/capture/photo.h"
#include "burin/render/bench.h"
#include "burin/render/board.h"
#include "burin/render/brdf.h"
#include "burin/render/carve.h"
#include "burin/render/face_grain.h"
#include "burin/render/finding.h"
#include "burin/render/lamp_size.h"
#include "burin/render/pixel_shading.h"

namespace burin {

/// A lamp as the fits move it. A spot's axis points from the lamp at `aim` on the plane z = 0 of the board, so that it
/// always points at the board's side; exponent 0 is a bare lamp, for which `aim` means nothing.
template <typename T>
struct LampModel {
  Eigen::Matrix<T, 3, 1> position_mm;
  T log_intensity;
  Eigen::Matrix<T, 2, 1> aim_mm;
  T exponent;
  /// Of a point of a lamp with an area from its middle, which the axis begins at.
  Eigen::Vector3d offset_mm{0, 0, 0};
};

/// Albedo of a tag's white or black paper, as board.json gives it.
inline double paper_albedo(const Board& board, SampleKind kind) {
  return kind == SampleKind::white_paper ? board.tags.white_albedo : board.tags.black_albedo;
}

/// Light that reaches a point, per solid angle and distance: (axis . -wi)^k / d^2, times exp(log_intensity). Gives wi,
/// the unit vector from the point towards the lamp.
template <typename T>
T lamp_irradiance(const LampModel<T>& lamp, const Eigen::Vector3d& p_board, Eigen::Matrix<T, 3, 1>& wi) {
  using std::exp;
  using std::pow;
  const Eigen::Matrix<T, 3, 1> to_lamp = lamp.position_mm - (p_board - lamp.offset_mm).template cast<T>();
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

/// Radiance of paper (Lambertian): albedo / pi cos I / d^2 + albedo * ambient * sample.around. Of a lamp with an area
/// the mean over `points` (lamp_points()); without them it is a point.
template <typename T>
T paper_radiance(const LampModel<T>& lamp, const T& ambient, double albedo, const LightSample& sample,
                 std::span<const LampPoint> points = {}) {
  const auto lit_by = [&](const LampModel<T>& point) {
    Eigen::Matrix<T, 3, 1> wi;
    const T irradiance = lamp_irradiance(point, sample.p_board, wi);
    const T cosine = wi.dot(sample.normal.cast<T>());
    return T((cosine > T(0) ? cosine : T(0)) * irradiance);
  };
  T lit(0);
  for (const LampPoint& point : points) {
    LampModel<T> at = lamp;
    at.offset_mm = point.offset_mm;
    lit += point.share * lit_by(at);
  }
  if (points.empty()) lit = lit_by(lamp);
  return albedo * (ambient * sample.around + lit / std::numbers::pi);
}

/// Radiance of the face between scratches: D G F / (4 wo.z) I / d^2 + F0 * ambient * sample.around, all with
/// base_alpha. `f0` is the mean of the channels; `grain` FaceGrain's c and s.
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

/// Prior of v1, v2, v3: lenses darken mostly as r^2, and photos hardly tell the higher orders from one another.
inline constexpr std::array<double, 3> kVignettePriorSigma{0.5, 0.25, 0.1};

struct LampOptions {
  double model_error = 0.02;  ///< relative error that a sample may have beyond its noise (uneven paper, haze, blur)
  bool fit_spot = true;       ///< try a spot where a bare lamp leaves more than it must
  /// Sigmas of positions and base_alpha from groups of samples that are left out in turn, where these say more than
  /// noise: errors of one photo, or of one place on the board, are alike. Takes a dozen fits.
  bool jackknife = false;
};

/// What paper and face say.
struct LampSeed {
  bool found = false;         ///< false: too little paper and face to say anything; see `findings`
  std::vector<Light> lights;  ///< as bench.lights, position, intensity, axis, exponent and position sigma filled in
  std::vector<Eigen::Vector2d> aim_mm;
  double base_alpha = 0;
  double base_alpha_sigma = 0;
  FaceGrain grain;     ///< where the face's shine asks for one
  double ambient = 0;  ///< mean of the channels; of photos under surroundings, their scale
  Eigen::Vector3d vignette{0, 0, 0};
  double residual_rms = 0;  ///< of log(photo / model), over the samples within the robust loss's core
  std::vector<Finding> findings;
};

/// Fits lamps, ambient light, vignetting and base_alpha to `samples`. Seeds: shading is linear after raising to the
/// power -2/3, and a ring of starts for where shading alone misleads (spots, vignetting).
LampSeed fit_lamps(std::span<const LightSample> samples, const Board& board, const Bench& bench,
                   const LampOptions& options = {});

/// The closed-form seed from paper alone: brightness s of white minus black at points p of a plane is
/// I Lz / (pi |L - p|^3), so s^(-2/3) is linear in (1, |L|^2, Lx, Ly): docs/model.md 9.4. Empty where that has no lamp
/// in front of the board.
std::optional<Eigen::Vector3d> lamp_from_shading(std::span<const Eigen::Vector3d> p_board,
                                                 std::span<const double> shading);

/// The same from samples that were gathered before (light_samples.h); `measured` names their lights.
Bench with_lamps(std::span<const LightSample> samples, const Board& board, const Bench& measured,
                 std::vector<Finding>& findings);

/// Finds the lamps of a calibrated bench from paper and face alone: what `burin calibrate` writes.
/// Also fills in material.base_alpha, ambient light and vignetting, and a verdict on each lamp.
/// Appends to `findings` what could not be found.
Bench with_lamps(std::span<const MergedView> photos, const Board& board, const Sent& sent, const Bench& measured,
                 std::vector<Finding>& findings);

}  // namespace burin
