// burin/optimize/layout/view_places.h - where to stand for the pictures of a new board: eyes whose half vectors lean
// towards azimuths 180 degrees / count apart, inside the grooves' reach. Frame: board, mm.
//
// A straight scratch glints for the half vectors across it, whichever way they lean, so the scratches of M pictures
// have the most room if their half vectors' azimuths are 180 j / M (docs/model.md 3.4, docs/design.md). For each lean
// the eye follows from the lamp by reflection; of all leans, signs and turns of the fan, those are taken where people
// can stand: about as high as each other, less than 45 degrees to the side, clear of the lamp.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace burin {

/// What places are looked for.
struct PlaceQuestion {
  int count = 1;
  Eigen::Vector3d lamp_mm{0, 0, 0};                        ///< in front of the face
  double distance_mm = 0;                                  ///< of the eyes from the carve area's middle
  Eigen::Vector2d carve_min_mm{0, 0}, carve_max_mm{0, 0};  ///< where half vectors must stay inside the reach
  double width_um = 400;                                   ///< of the tool
  double depth_um = 14;                                    ///< of the grooves
  double alpha = 0.04;                                     ///< their roughness
};

/// Eyes from left to right, at that distance; nothing if there are none for such grooves from there (closer eyes and
/// lamps want deeper grooves). Same question, same answer.
std::optional<std::vector<Eigen::Vector3d>> view_places(const PlaceQuestion& question);

}  // namespace burin
