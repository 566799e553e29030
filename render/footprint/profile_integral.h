// burin/render/footprint/profile_integral.h - footprint integral of a groove with a cross-section in bands
// (groove_profile.h). footprint_integral.h is its counterpart for the paper's section. docs/model.md 4.24 to 4.26.
//
//   Dhat = sum over bands of (area of the band within the footprint) * (mean of the NDF over the band)
//
// The areas are exact; the means have an error of 1e-6 of the band's peak. If a footprint's edge runs along the groove
// within a band, light counts as even over the band, which is some micrometers wide.
#pragma once

#include <Eigen/Core>
#include <span>

#include "burin/render/footprint/footprint_integral.h"
#include "burin/scene/groove_profile.h"

namespace burin {

/// The mean of the NDF over a band, with its derivatives.
struct BandLight {
  double value = 0, by_alpha = 0, by_from_lean = 0, by_to_lean = 0;
  Eigen::Vector3d by_h{0, 0, 0};
};

/// `h`: unit vector, scratch frame. `alpha`: roughness along the groove; `across` times `alpha`: roughness across it.
BandLight band_light(const ProfileBand& band, const Eigen::Vector3d& h, double alpha, double across);

/// As footprint_integral(): `groove` gives alpha and length; `bands` give the cross-section.
FootprintValue profile_integral(const GrooveSegment& groove, std::span<const ProfileBand> bands, double across,
                                const Quad& corners_mm, const Eigen::Vector3d& h_scratch);
/// As footprint_integral_gradient().
FootprintGradient profile_integral_gradient(const GrooveSegment& groove, std::span<const ProfileBand> bands,
                                            double across, const Quad& corners_mm, const Eigen::Vector3d& h_scratch);

}  // namespace burin
