// burin/simulate/around_sampler.h - importance sampling of directions for the simulated camera under an environment
// map: by its brightness, and by the lobe of a rough facet. Shares nothing with the renderer's tables. Frame: board.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <vector>

#include "burin/scene/far_light.h"

namespace burin {

/// A rough facet: its unit normal, and a unit vector in it. Across that vector the facet is `ratio` times as rough as
/// along it (alpha).
struct RoughFacet {
  Eigen::Vector3d normal, across;
  double alpha, ratio;
};

/// Draws pixels of a panorama by radiance times solid angle, with their cumulative sum.
class AroundSampler {
 public:
  explicit AroundSampler(std::shared_ptr<const Panorama> panorama);

  /// One direction's estimate of a facet's radiance towards `wo`, R G B. `face` is the normal of the face that shadows
  /// as a whole, at the roughness along (docs/model.md 3.2); `u`: four random numbers, 0 to 1. Half of the directions
  /// come from the environment map, half from the facet's lobe (one sample, balance heuristic: Veach and Guibas,
  /// SIGGRAPH 1995). The mean over many is the integral 10.1.
  Eigen::Vector3d reflected(const RoughFacet& facet, const Eigen::Vector3d& face, const Eigen::Vector3d& wo,
                            const Eigen::Vector3d& f0, const double (&u)[4]) const;

 private:
  Eigen::Vector3d draw(double a, double b, double c) const;
  double density(std::size_t pixel) const;  ///< density of draw(), per steradian

  std::shared_ptr<const Panorama> panorama_;
  std::vector<double> until_;  ///< cumulative share of each pixel
};

}  // namespace burin
