// burin/render/footprint/footprint_types.h - what the footprint integral takes and gives, whatever scalar it is
// computed in. The integral itself: footprint_integral.h. Frame: scratch (origin at its first end, y along it, x across
// it), mm.
#pragma once

#include <Eigen/Core>
#include <array>

namespace burin {

/// One scratch as the integral sees it.
struct GrooveSegment {
  double width_um = 0;  ///< w-tilde
  double depth_um = 0;  ///< d
  double alpha = 0;     ///< GGX roughness, 0 < alpha <= 1
  double length_mm = 0;
};

/// A pixel's footprint: four corners in the scratch frame, mm, in order (either orientation). Convex, or degenerate.
using Quad = std::array<Eigen::Vector2d, 4>;

/// Value and area, positive for either orientation of the quad. Never NaN for finite input; backfacing parts of the
/// groove (n.h <= 0) count as D = 0. `h_scratch` need not be of unit length: the value is that for h / |h|.
struct FootprintValue {
  double Dhat_mm2 = 0;
  double area_mm2 = 0;
};

/// Derivatives of both. d_half is that of D as a function of n.h alone with hx, hy, hz taken as free, so its second
/// component is 0 (docs/model.md 4.20); only its part tangential to h means anything.
struct FootprintGradient {
  FootprintValue value;
  Eigen::Vector3d dDhat_dhalf{0, 0, 0};
  double dDhat_dalpha = 0;
  double dDhat_dwidth_um = 0, darea_dwidth_um = 0;  ///< w moves with the width
  double dDhat_ddepth_um = 0, darea_ddepth_um = 0;
  double dDhat_dlength_mm = 0, darea_dlength_mm = 0;  ///< the second end moves, the first stays
  std::array<Eigen::Vector2d, 4> dDhat_dcorner;       ///< per mm
  std::array<Eigen::Vector2d, 4> darea_dcorner;
};

}  // namespace burin
