// burin/calib/light/probe/outline_edges.h - edges in a picture where a ball's outline should be. docs/model.md 11.4.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "burin/calib/light/probe/ball_view.h"
#include "burin/calib/light/probe/mirror_ball.h"

namespace burin {

/// Directions around an outline in which edges are looked for.
inline constexpr int kOutlineTurns = 180;

/// An edge, and where it is seen.
struct OutlineEdge {
  int view = 0;         ///< index into the views
  double turn = 0;      ///< about the tangent cone, rad
  double off_px = 0;    ///< outside of where the ball says, photo pixels
  Eigen::Vector3d ray;  ///< board, unit
};

/// Which edge is the outline: a plain one near where it should be; or, once that is about right, the outermost one that
/// is not weak beside others. Within its outline a mirror ball shows what lies around, in strips that get narrower.
enum class PickEdge { nearest, outermost };

/// Edges within `reach` (of the radius, 3 pixels at least) of the ball's outline, at most one a direction.
std::vector<OutlineEdge> edges_about(std::span<const BallView> views, const MirrorBall& ball, double reach,
                                     PickEdge pick);

/// Share of the directions around the ball in which an edge lies on its outline, within a pixel or a hundredth of the
/// radius, that is not weak beside other edges nearby. By chance about a quarter.
double share_with_edge(const BallView& view, const MirrorBall& ball);

/// Photo pixels a radian in the directions of a tangent cone.
double pixels_per_rad(const BallView& view, const TangentCone& cone);

}  // namespace burin
