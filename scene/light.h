// burin/scene/light.h - what shines on the board: a near lamp, or the sun, or surroundings. Frame: board, mm.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace burin {

struct FarLight;  // burin/scene/far_light.h

/// The area of a lamp, across its axis: nothing (a point), a disk, or a panel. At most one of the two is given.
struct LampSize {
  double disk_mm = 0;  ///< the disk's radius
  /// The panel's two sides, the first along the board's x before it is turned by `turn_deg` about the lamp's axis.
  Eigen::Vector2d panel_mm{0, 0};
  double turn_deg = 0;
  std::optional<double> disk_sigma_mm;            ///< where the radius was measured from photos
  std::optional<Eigen::Vector2d> panel_sigma_mm;  ///< where the sides were
  std::optional<double> turn_sigma_deg;           ///< and their direction

  /// Whether photos told it, not a person.
  bool is_measured() const { return disk_sigma_mm.has_value() || panel_sigma_mm.has_value(); }
  bool is_point() const { return !(disk_mm > 0) && !(panel_mm.maxCoeff() > 0); }
};

/// A near lamp: a point with color, or an area, and a direction and fall-off when it is a spot (docs/model.md 5.5):
/// I(w) = intensity * max(0, axis . (-wi))^falloff_exponent, with exponent 0 for a bare lamp. With `far`: the sun, or
/// surroundings (burin/scene/far_light.h). With `also`: several lights that shine at once, this one among them.
struct Light {
  std::string id = "lamp";
  Eigen::Vector3d position_mm{0, 0, 0};
  std::optional<Eigen::Vector3d> position_sigma_mm;
  Eigen::Vector3d intensity{1, 1, 1};  ///< radiant intensity, R G B; with Sensor::gain = 1 when it was measured
  std::optional<Eigen::Vector3d> intensity_sigma;
  Eigen::Vector3d axis{0, 0, -1};  ///< unit, from the lamp
  double falloff_exponent = 0;
  std::optional<double> falloff_exponent_sigma;
  LampSize size;  ///< its area across the axis; position_mm is its middle
  /// The sun or surroundings: then position_mm is a place far away in the direction that most light comes from, and
  /// intensity the sun's irradiance, or a factor on the surroundings' radiance. Null for a near lamp.
  std::shared_ptr<const FarLight> far;
  std::vector<Light> also;  ///< lights that shine beside this one (which have none of their own)

  bool is_near() const { return far == nullptr; }
  /// One near lamp and nothing else: what photos can measure.
  bool is_lamp() const { return far == nullptr && also.empty(); }
};

}  // namespace burin
