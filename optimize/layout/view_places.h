// burin/optimize/layout/view_places.h - viewpoints for the pictures of a new board. Their half vectors tilt towards
// azimuths 180 degrees / count apart, below the grooves' cutoff angle. Frame: board, mm.
//
// A straight scratch glints for half vectors across it, tilted to either side. The scratches of M pictures therefore
// have the most room if their half vectors' azimuths are 180 j / M (docs/model.md 3.4, docs/design.md). For each tilt,
// reflection of the lamp gives the eye. The search covers tilts, signs and rotations of the fan. It takes positions at
// which people can stand: about equally high, less than 45 degrees to the side, clear of the lamp.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace burin {

/// Input of the search for viewpoints.
struct PlaceQuestion {
  int count = 1;
  Eigen::Vector3d lamp_mm{0, 0, 0};  ///< in front of the face
  double distance_mm = 0;            ///< of the eyes from the carve area's middle
  /// Half vectors stay below the cutoff angle all over this rectangle.
  Eigen::Vector2d carve_min_mm{0, 0}, carve_max_mm{0, 0};
  double width_um = 400;  ///< of the tool
  double depth_um = 14;   ///< of the grooves
  double alpha = 0.04;    ///< their roughness
};

/// Eyes from left to right, at this distance; nothing if such grooves allow none (closer eyes and lamps need deeper
/// grooves). The same question gives the same answer.
std::optional<std::vector<Eigen::Vector3d>> view_places(const PlaceQuestion& question);

}  // namespace burin
