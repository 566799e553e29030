// burin/render/surroundings/face_light.h - light of the plain face under an environment map, per pixel. It varies
// slowly, so it is interpolated between the places of a lattice.
#pragma once

#include <vector>

#include "burin/render/surroundings/facet_table.h"

namespace burin {

/// Radiance of the face and its derivative by log(base_alpha), channels per pixel. 0 for pixels without a footprint or
/// with the camera behind the face.
struct FaceLight {
  std::vector<float> light, by_log_alpha;
};
FaceLight face_light(const ViewScene& scene, const Light& light, int channels, const PlaceLattice& lattice);

}  // namespace burin
