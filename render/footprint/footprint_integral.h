// burin/render/footprint/footprint_integral.h - closed-form integral of the groove's NDF over one pixel's footprint.
//
//   Dhat(h) = integral of D(h, n(x)) dx dy over the footprint cut with { |x| <= w, 0 <= y <= L }        [mm^2]
//   area    = area of that region                                                                       [mm^2]
//
// Frame: scratch (origin at its first end, y along it, x across it), mm. h is in the scratch frame.
// Source: Shen et al. 2023, Eqns. 2, 6-10 and supplement 1.2, 2; the stable form is docs/model.md 4.
#pragma once

#include <Eigen/Core>

#include "burin/render/footprint/footprint_types.h"

namespace burin {

/// Double-precision reference.
FootprintValue footprint_integral(const GrooveSegment& groove, const Quad& corners_mm,
                                  const Eigen::Vector3d& h_scratch);
FootprintGradient footprint_integral_gradient(const GrooveSegment& groove, const Quad& corners_mm,
                                              const Eigen::Vector3d& h_scratch);

}  // namespace burin
