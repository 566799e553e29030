// burin/render/surroundings/face_light.h - what the plain face sends under surroundings, pixel by pixel: it varies
// slowly, so it is interpolated between the places of a lattice.
#pragma once

#include <vector>

#include "burin/render/surroundings/facet_table.h"

namespace burin {

/// Radiance of the face, and by log(base_alpha): channels a pixel. 0 where the grid has no footprint or the camera is
/// behind the face.
struct FaceLight {
  std::vector<float> light, by_log_alpha;
};
FaceLight face_light(const ViewScene& scene, const Light& light, int channels, const PlaceLattice& lattice);

}  // namespace burin
