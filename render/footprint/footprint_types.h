// burin/render/footprint/footprint_types.h - inputs and results of the footprint integral for any scalar type.
// footprint_integral.h computes it. Frame: scratch (origin at its first end, y along it, x across it), mm.
#pragma once

#include <Eigen/Core>
#include <array>

namespace burin {

/// One scratch as input of the integral.
struct GrooveSegment {
  double width_um = 0;  ///< w-tilde
  double depth_um = 0;  ///< d
  double alpha = 0;     ///< GGX roughness, 0 < alpha <= 1
  double length_mm = 0;
};

/// A pixel's footprint: four corners in the scratch frame, mm, in order (either orientation). Convex, or degenerate.
using Quad = std::array<Eigen::Vector2d, 4>;

/// Value and area, positive for either orientation of the quad. Never NaN for finite input. Backfacing parts of the
/// groove (n.h <= 0) count as D = 0. `h_scratch` may have any length: the value is that for h / |h|.
struct FootprintValue {
  double Dhat_mm2 = 0;
  double area_mm2 = 0;
};

/// Derivatives of value and area. dDhat_dhalf treats D as a function of n.h alone with hx, hy, hz free, so its second
/// component is 0 (docs/model.md 4.20). Only its part tangential to h has a meaning.
struct FootprintGradient {
  FootprintValue value;
  Eigen::Vector3d dDhat_dhalf{0, 0, 0};
  double dDhat_dalpha = 0;
  double dDhat_dwidth_um = 0, darea_dwidth_um = 0;  ///< w moves with the width
  double dDhat_ddepth_um = 0, darea_ddepth_um = 0;
  double dDhat_dlength_mm = 0, darea_dlength_mm = 0;  ///< the second end moves; the first stays
  std::array<Eigen::Vector2d, 4> dDhat_dcorner;       ///< per mm
  std::array<Eigen::Vector2d, 4> darea_dcorner;
};

}  // namespace burin
