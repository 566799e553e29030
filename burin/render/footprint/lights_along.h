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

/// Of one groove. Knots lie evenly on the chord of the half vectors that its pixels have, an eighth of the roughness
/// apart at most; between two, light is a cubic along the chord, and goes straight beside it.
class LightsAlong {
 public:
  /// `half`: the half vectors of the groove's pixels, unit, in any order; `slopes`: whether at() will be asked for
  /// them. Where pixels are so few that each is better asked for by itself, there are no knots.
  void set(const GrooveSegment& groove, std::span<const ProfileBand> bands, double across,
           std::span<const Eigen::Vector3d> half, bool slopes);

  /// The bands' light at a half vector; without `slopes`, `out.value` alone. False, and nothing is written, where it
  /// does not follow from the knots: there are none, or it lies further beside the chord than a sixteenth of the
  /// roughness.
  bool at(const Eigen::Vector3d& h, bool slopes, BandLights& out) const;

 private:
  Eigen::Vector3d first_{0, 0, 0}, step_{0, 0, 0};  ///< the chord's beginning, and from knot to knot
  double beside2_ = 0;                              ///< how far beside the chord light goes straight, squared
  std::size_t count_ = 0;                           ///< of knots
  std::vector<BandLights> knots_;                   ///< the first `count_`: the others' memory is kept
};

}  // namespace burin
