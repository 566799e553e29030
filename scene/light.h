// burin/scene/light.h - a light: a near lamp (point or area light, spotlight), the sun, or an environment map. Frame:
// board, mm.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace burin {

struct FarLight;  // burin/scene/far_light.h

/// The area of a lamp, across its axis: none (a point), a disk, or a panel. At most one of the two is given.
struct LampSize {
  double disk_mm = 0;  ///< the disk's radius
  /// The panel's two sides; the first is along the board's x, turned by `turn_deg` about the lamp's axis.
  Eigen::Vector2d panel_mm{0, 0};
  double turn_deg = 0;
  std::optional<double> disk_sigma_mm;            ///< if the radius was measured from photos
  std::optional<Eigen::Vector2d> panel_sigma_mm;  ///< if the sides were measured
  std::optional<double> turn_sigma_deg;           ///< if the direction was measured

  /// True for an area from photos; false for a person's.
  bool is_measured() const { return disk_sigma_mm.has_value() || panel_sigma_mm.has_value(); }
  /// True for a lamp without size.
  bool is_point() const { return !(disk_mm > 0) && !(panel_mm.maxCoeff() > 0); }
};

/// A near lamp: a point or area light with a color, and with an axis and falloff if it is a spotlight (docs/model.md
/// 5.5): I(w) = intensity * max(0, axis . (-wi))^falloff_exponent, with exponent 0 for a bare lamp. With `far`: the
/// sun, or an environment map (burin/scene/far_light.h). With `also`: several simultaneous lights, this one included.
struct Light {
  std::string id = "lamp";
  Eigen::Vector3d position_mm{0, 0, 0};
  std::optional<Eigen::Vector3d> position_sigma_mm;
  /// Radiant intensity, R G B; a measured one refers to Sensor::gain = 1.
  Eigen::Vector3d intensity{1, 1, 1};
  std::optional<Eigen::Vector3d> intensity_sigma;
  Eigen::Vector3d axis{0, 0, -1};  ///< unit, from the lamp
  double falloff_exponent = 0;
  std::optional<double> falloff_exponent_sigma;
  LampSize size;  ///< its area across the axis; position_mm is its middle
  /// The sun or an environment map; null for a near lamp. position_mm is then a point far away in the direction of most
  /// of the light. intensity is the sun's irradiance, or a factor on the environment map's radiance.
  std::shared_ptr<const FarLight> far;
  std::vector<Light> also;  ///< simultaneous lights in addition to this one; their own `also` is empty

  /// True for a lamp at a finite distance.
  bool is_near() const { return far == nullptr; }
  /// True for a single near lamp, the only kind that photos can measure.
  bool is_lamp() const { return far == nullptr && also.empty(); }
};

}  // namespace burin
