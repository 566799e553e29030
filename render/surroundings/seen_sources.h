// burin/render/surroundings/seen_sources.h - an environment map, or an area light, as many small sources. A place of
// the face sees them as half vectors and strengths, a run of sources at a time. docs/model.md 10.5. Frames: board; face
// (pixel_shading.h).
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "burin/render/view_scene.h"
#include "burin/scene/light.h"

namespace burin {

/// Flat arrays, padded to whole SIMD vectors with sources of zero power.
struct LightSources {
  std::vector<float> x, y, z;   ///< directions to them (board); of a lamp positions, mm
  std::vector<float> power[3];  ///< R G B: radiance times solid angle; of a lamp its share of the light
};

/// Sources of a spacing that suits half vectors `fine` radians apart.
LightSources light_sources(const Light& light, double fine);

/// Irradiance of a plane by an environment map's sources (R G B), without the light's intensity. It approximates the
/// sum of far_light.h over a picture's pixels and suits many normals. Sources 0.01 apart have an error of 1e-3.
Eigen::Vector3d irradiance(const LightSources& sources, const Eigen::Vector3d& normal);

/// A run of sources as seen from one place.
struct SeenSources {
  static constexpr int kMost = 256;
  int count = 0;
  float cos_o = 0;
  alignas(64) float x[kMost], y[kMost], z[kMost];  ///< half vectors (face)
  alignas(64) float cos_i[kMost];                  ///< 0 if the source is below the face
  /// Factor of the lobe D G; with one channel the mean, in the first.
  alignas(64) float strength[3][kMost];
  bool is_above(int k) const { return cos_i[k] > 0; }
};

/// visit(run) for all sources, as seen from the face at the middle of a pixel. Omits runs that are wholly below the
/// face.
void each_seen(const ViewScene& scene, const Light& light, int channels, std::size_t pixel, const LightSources& sources,
               const std::function<void(const SeenSources&)>& visit);

}  // namespace burin
