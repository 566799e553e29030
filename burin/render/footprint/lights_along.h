// burin/render/footprint/lights_along.h - the light of a groove's bands along the groove, from a few half vectors:
// band_light() (profile_integral.h) is dear, and half vectors turn slowly from a pixel to the next. docs/model.md 4.27.
//
// Frame: the scratch's own (scratch_pair.h).
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "burin/render/footprint/profile_integral.h"

namespace burin {

/// Of one groove. Knots lie evenly on the chord of the half vectors that its pixels have; between two, light is a cubic
/// along the chord, and goes straight beside it. Where knots lie a tenth of the roughness apart, that is good to 1e-4
/// of a band's highest light on the chord.
class LightsAlong {
 public:
  /// `half`: the half vectors of the groove's pixels, unit, in any order; `slopes`: whether at() will be asked for
  /// them. Knows nothing where pixels are so few that each is better asked for by itself: knows() says so.
  void set(const GrooveSegment& groove, std::span<const ProfileBand> bands, double across,
           std::span<const Eigen::Vector3d> half, bool slopes);

  /// Whether light at `h` follows from the knots: none may lie further beside the chord than a sixteenth of the
  /// roughness.
  bool knows(const Eigen::Vector3d& h) const;

  /// The bands' light at a half vector that it knows. Without `slopes`, `out.value` alone.
  void at(const Eigen::Vector3d& h, bool slopes, BandLights& out) const;

 private:
  Eigen::Vector3d first_{0, 0, 0}, step_{0, 0, 0};  ///< the chord's beginning, and from knot to knot
  double step2_ = 0, beside2_ = 0;
  std::size_t steps_ = 0;  ///< of knots less one
  std::vector<BandLights> knots_;
  std::size_t known_ = 0;  ///< knots that are set; 0: none
};

}  // namespace burin
