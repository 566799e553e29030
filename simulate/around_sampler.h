// burin/simulate/around_sampler.h - directions drawn from surroundings, for the simulated camera: by how
// bright they are, and by where a rough facet sends the eye. Shares nothing with the renderer's tables. Frame: board.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <vector>

#include "burin/scene/far_light.h"

namespace burin {

/// A rough facet: its normal, unit; a unit vector in it, across which it is `ratio` times as rough as along (alpha).
struct RoughFacet {
  Eigen::Vector3d normal, across;
  double alpha, ratio;
};

/// Pixels of a panorama drawn by radiance times solid angle, by their running sum.
class AroundSampler {
 public:
  explicit AroundSampler(std::shared_ptr<const Panorama> panorama);

  /// One direction's estimate of what a facet sends to `wo`: radiance, R G B. `face`: normal of the face that shadows
  /// as a whole, at the roughness along (docs/model.md 3.2); `u`: four random numbers, 0 to 1. Half of the directions
  /// are drawn from the surroundings, half from the facet's lobe (one sample, balance heuristic: Veach and Guibas,
  /// SIGGRAPH 1995). The mean over many is the integral 10.1.
  Eigen::Vector3d reflected(const RoughFacet& facet, const Eigen::Vector3d& face, const Eigen::Vector3d& wo,
                            const Eigen::Vector3d& f0, const double (&u)[4]) const;

 private:
  Eigen::Vector3d draw(double a, double b, double c) const;
  double density(std::size_t pixel) const;  ///< of draw(), per steradian

  std::shared_ptr<const Panorama> panorama_;
  std::vector<double> until_;  ///< running share of each pixel
};

}  // namespace burin
