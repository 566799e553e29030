// burin/render/exact/scratch_pair.h - one scratch in one pixel, in double: from the footprint integral's frame to the
// board.
//
// The scratch's frame has y = (p1 - p0) / L along it and x across it. A pixel's corners, and its half vector in the
// frame of the face (pixel_shading.h), are rotated into it. Derivatives are rotated back. An end that moves shifts and
// turns this frame, which moves corners and half vector, and changes L (docs/model.md 4.23). Frame: board xy, mm.
#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <vector>

#include "burin/render/footprint/footprint_integral.h"
#include "burin/render/footprint/profile_integral.h"
#include "burin/scene/board.h"
#include "burin/scene/groove_profile.h"
#include "burin/scene/scratches.h"

namespace burin {

/// A scratch's own frame and cross-section.
struct ScratchFrame {
  Eigen::Vector2d p0{0, 0}, x{1, 0}, y{0, 1};
  GrooveSegment groove;
  /// of a cross-section other than the paper's; null for the paper's
  std::shared_ptr<const std::vector<ProfileBand>> bands;
  double across = 1;  ///< GrooveProfile::across of this section
};

/// The frame without bands.
inline ScratchFrame scratch_frame(const Scratches& s, std::size_t i, double width_um, const Material& material) {
  const double depth_um = material.depth_um, alpha = material.alpha;
  ScratchFrame f;
  f.p0 = {s.x0_mm[i], s.y0_mm[i]};
  const Eigen::Vector2d d = Eigen::Vector2d(s.x1_mm[i], s.y1_mm[i]) - f.p0;
  f.groove.length_mm = d.norm();
  if (f.groove.length_mm > 0) f.y = d / f.groove.length_mm;
  f.x = {f.y.y(), -f.y.x()};
  f.groove.width_um = s.width_um.empty() ? width_um : s.width_um[i];
  f.groove.depth_um = s.depth_um.empty() ? depth_um : s.depth_um[i];
  f.groove.alpha = s.alpha.empty() ? alpha : s.alpha[i];
  f.across = material.profile.is_paper() ? 1 : material.profile.across;
  return f;
}

/// Frames of all scratches, in order. Scratches of one width and depth share their section, because pieces of a bent or
/// cut groove are many. `widest_um` as in profile_bands().
std::vector<ScratchFrame> scratch_frames(const Scratches& scratches, double width_um, const Material& material,
                                         double widest_um = 15);

/// Footprint integral for any cross-section, without or with derivatives.
inline FootprintValue pair_integral(const ScratchFrame& f, const Quad& corners, const Eigen::Vector3d& h) {
  return f.bands == nullptr ? footprint_integral(f.groove, corners, h)
                            : profile_integral(f.groove, *f.bands, f.across, corners, h);
}
inline FootprintGradient pair_integral_gradient(const ScratchFrame& f, const Quad& corners, const Eigen::Vector3d& h) {
  return f.bands == nullptr ? footprint_integral_gradient(f.groove, corners, h)
                            : profile_integral_gradient(f.groove, *f.bands, f.across, corners, h);
}

inline Quad in_scratch(const ScratchFrame& f, const std::array<Eigen::Vector2d, 4>& corners_mm) {
  Quad q;
  for (int i = 0; i < 4; ++i) q[i] = {f.x.dot(corners_mm[i] - f.p0), f.y.dot(corners_mm[i] - f.p0)};
  return q;
}

inline Eigen::Vector3d in_scratch(const ScratchFrame& f, const Eigen::Vector3d& h_face) {
  return {f.x.dot(h_face.head<2>()), f.y.dot(h_face.head<2>()), h_face.z()};
}

/// Derivatives of one quantity by the scratch's ends and by the pixel's geometry, in the board's axes.
struct PairGradient {
  Eigen::Vector2d p0{0, 0}, p1{0, 0};
  Eigen::Vector3d h_face{0, 0, 0};
  std::array<Eigen::Vector2d, 4> corner{};
};

/// Converts derivatives in the scratch's frame (corners, half vector, length) to the board's.
inline PairGradient to_board(const ScratchFrame& f, const Quad& q, const Eigen::Vector3d& h_scratch,
                             const std::array<Eigen::Vector2d, 4>& by_corner, const Eigen::Vector3d& by_half,
                             double by_length) {
  PairGradient g;
  // A turn of the frame by phi turns its contents by -phi.
  double by_turn = by_half.x() * h_scratch.y() - by_half.y() * h_scratch.x();
  Eigen::Vector2d by_shift(0, 0);
  for (int i = 0; i < 4; ++i) {
    by_turn += by_corner[i].x() * q[i].y() - by_corner[i].y() * q[i].x();
    by_shift += by_corner[i];
    g.corner[i] = f.x * by_corner[i].x() + f.y * by_corner[i].y();
  }
  const Eigen::Vector2d end = -f.x * (by_turn / f.groove.length_mm) + f.y * by_length;
  g.p1 = end;
  g.p0 = -end - f.x * by_shift.x() - f.y * by_shift.y();
  g.h_face.head<2>() = f.x * by_half.x() + f.y * by_half.y();
  g.h_face.z() = by_half.z();
  return g;
}

}  // namespace burin
