// burin/render/surroundings/seen_sources.h - surroundings, or a lamp's area, as many small sources, and how a place of
// the face sees them: half vectors and strengths, a run of sources at a time. docs/model.md 10.5. Frames: board; face
// (pixel_shading.h).
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "burin/render/view_scene.h"
#include "burin/scene/light.h"

namespace burin {

/// Flat arrays, a whole number of packets long; what fills the last one has no power.
struct LightSources {
  std::vector<float> x, y, z;   ///< directions to them (board); of a lamp places, mm
  std::vector<float> power[3];  ///< R G B: radiance times solid angle; of a lamp its share of the light
};

/// Sources as close together as half vectors `fine` radians apart ask for.
LightSources light_sources(const Light& light, double fine);

/// What surroundings' sources bring to a plane (R G B), without the light's intensity: the sum of far_light.h over a
/// picture's pixels, for those who ask for many normals. Sources 0.01 apart give it within 1e-3.
Eigen::Vector3d irradiance(const LightSources& sources, const Eigen::Vector3d& normal);

/// A run of sources as one place sees them.
struct SeenSources {
  static constexpr int kMost = 256;
  int count = 0;
  float cos_o = 0;
  alignas(64) float x[kMost], y[kMost], z[kMost];  ///< half vectors (face)
  alignas(64) float cos_i[kMost];                  ///< 0 where the source is below the face
  /// What the lobe D G is to be multiplied with; with one channel in the first, the mean.
  alignas(64) float strength[3][kMost];
  bool is_above(int k) const { return cos_i[k] > 0; }
};

/// visit(run) for all sources, as the face at the middle of a pixel sees them. Runs that are wholly below are left out.
void each_seen(const ViewScene& scene, const Light& light, int channels, std::size_t pixel, const LightSources& sources,
               const std::function<void(const SeenSources&)>& visit);

}  // namespace burin
