// burin/render/surroundings/facet_table.h - what a small rough facet sends to the eye under surroundings, tabulated.
// docs/model.md 10.5 to 10.7. Frames: board; face (pixel_shading.h).
//
// A groove is facets whose normals lean across it, so its light under any surroundings is the facet's light along a
// line through this table. The light of a facet of normal n is an integral over half vectors of what their mirror
// directions bring, weighted by the GGX lobe around n: a convolution on the sphere with a lobe that knows the angle
// alone. On rings of one lean it is a convolution over azimuth, which Fourier's transform makes a product. The eye's
// direction changes over the board: the table is made at a lattice of pixels and interpolated between them (cubically).
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

/// Four neighbors on an axis and their shares (Lagrange's cubic), with the shares' slopes by the place.
struct CubicShares {
  int first = 0;
  double share[4] = {}, slope[4] = {};
};
/// Of a place on an axis of `count` nodes (at least four); on a ring of as many where `periodic`, which `first` may
/// leave (take it modulo count).
inline CubicShares cubic_shares(double place, int count, bool periodic) {
  CubicShares out;
  out.first = static_cast<int>(std::floor(place)) - 1;
  if (!periodic) out.first = std::clamp(out.first, 0, count - 4);
  lagrange_cubic(place - out.first - 1, out.share, out.slope);
  return out;
}

/// The light of facets. Normals: lean 2 atan(t) for t = k * t_step, k = 0 .. t_count - 1, azimuth (face) j * 360 /
/// azimuths degrees. Places: pixels of the view's grid, columns x rows of them, evenly spread.
struct FacetTable {
  int channels = 1, t_count = 0, azimuths = 0, columns = 0, rows = 0;
  double t_step = 0;
  double column_pixels = 1, row_pixels = 1;  ///< pixels from a node to the next
  std::vector<float> light;                  ///< [row][column][azimuth][channel][t]
  std::size_t ring_size() const { return static_cast<std::size_t>(t_count) * channels; }
  const float* at(int node, int azimuth) const {
    return &light[(static_cast<std::size_t>(node) * azimuths + azimuth) * ring_size()];
  }
};

/// What the plain face sends at a lattice of pixels, and by log(base_alpha).
struct FaceTable {
  std::vector<float> light, by_log_alpha;  ///< [row][column][channel]
};

/// How the lattice of places lies: as fine as the eye's direction asks for, at a roughness.
struct PlaceLattice {
  int columns = 4, rows = 4;
  double column_pixels = 1, row_pixels = 1;
  double lean_per_pixel = 0;       ///< by how much the half vector turns from a pixel to the next, at most about
  std::vector<std::size_t> pixel;  ///< of each node: one with a footprint; empty where the grid has none
};
PlaceLattice place_lattice(const ViewScene& scene, const Light& light, double alpha);

/// Facets of roughness `alpha` whose normals lean up to 2 atan(steepest_t), under `light`: surroundings, or a lamp with
/// an area. Where the scene's grooves are rougher across than along, so are facets in the direction in which they lean.
FacetTable make_facet_table(const ViewScene& scene, const Light& light, int channels, const PlaceLattice& lattice,
                            double alpha, double steepest_t);

/// The plain face of scene.material, under the same.
FaceTable make_face_table(const ViewScene& scene, const Light& light, int channels, const PlaceLattice& lattice);

}  // namespace burin
