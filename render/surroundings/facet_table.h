// burin/render/surroundings/facet_table.h - tabulated light of a small rough facet under an environment map.
// docs/model.md 10.5 to 10.7. Frames: board; face (pixel_shading.h).
//
// A groove consists of facets whose normals lean across it, so its light under any environment map follows from a line
// through this table. The light of a facet of normal n is an integral over half vectors: the light of their mirror
// directions, weighted by the GGX lobe around n. It is a convolution on the sphere with a lobe that depends on the
// angle alone. On rings of one lean it is a convolution over azimuth, which the Fourier transform turns into a product.
// The eye's direction changes over the board, so the table exists at a lattice of pixels, with cubic interpolation in
// between.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "burin/render/surroundings/lagrange_cubic.h"
#include "burin/render/view_scene.h"
#include "burin/scene/far_light.h"
#include "burin/scene/light.h"

namespace burin {

/// Four neighbors on an axis and their weights (Lagrange's cubic), with the weights' derivatives by the position.
struct CubicShares {
  int first = 0;
  double share[4] = {}, slope[4] = {};
};
/// Weights of a position on an axis of `count` nodes (at least four). If `periodic`, the axis is a ring and `first` may
/// leave it (take it modulo count).
inline CubicShares cubic_shares(double place, int count, bool periodic) {
  CubicShares out;
  out.first = static_cast<int>(std::floor(place)) - 1;
  if (!periodic) out.first = std::clamp(out.first, 0, count - 4);
  lagrange_cubic(place - out.first - 1, out.share, out.slope);
  return out;
}

/// The light of facets. Normals have the lean 2 atan(t) for t = k * t_step, k = 0 .. t_count - 1, and the azimuth
/// (face) j * 360 / azimuths degrees. Places are pixels of the view's grid, columns x rows of them, evenly spread.
struct FacetTable {
  int channels = 1, t_count = 0, azimuths = 0, columns = 0, rows = 0;
  double t_step = 0;
  double column_pixels = 1, row_pixels = 1;  ///< pixels between nodes
  std::vector<float> light;                  ///< [row][column][azimuth][channel][t]
  std::size_t ring_size() const { return static_cast<std::size_t>(t_count) * channels; }
  const float* at(int node, int azimuth) const {
    return &light[(static_cast<std::size_t>(node) * azimuths + azimuth) * ring_size()];
  }
};

/// Light of the plain face at a lattice of pixels, and its derivative by log(base_alpha).
struct FaceTable {
  std::vector<float> light, by_log_alpha;  ///< [row][column][channel]
};

/// Layout of the lattice of places: its spacing follows from the change of the eye's direction and a roughness.
struct PlaceLattice {
  int columns = 4, rows = 4;
  double column_pixels = 1, row_pixels = 1;
  double lean_per_pixel = 0;       ///< approximate maximum of the half vector's turn per pixel
  std::vector<std::size_t> pixel;  ///< one pixel with a footprint per node; empty if the grid has none
};
PlaceLattice place_lattice(const ViewScene& scene, const Light& light, double alpha);

/// Facets of roughness `alpha` with leans up to 2 atan(steepest_t), under `light`: an environment map or an area light.
/// If the scene's grooves are rougher across than along, facets are rougher in the direction of their lean.
FacetTable make_facet_table(const ViewScene& scene, const Light& light, int channels, const PlaceLattice& lattice,
                            double alpha, double steepest_t);

/// The plain face of scene.material, under the same light.
FaceTable make_face_table(const ViewScene& scene, const Light& light, int channels, const PlaceLattice& lattice);

}  // namespace burin
