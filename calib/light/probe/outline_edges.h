// burin/calib/light/probe/outline_edges.h - finds edges near a ball's predicted outline. docs/model.md 11.4.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "burin/calib/light/probe/ball_view.h"
#include "burin/calib/light/probe/mirror_ball.h"

namespace burin {

/// Number of directions around an outline in which edges are sought.
inline constexpr int kOutlineTurns = 180;

/// An edge with its place in a view.
struct OutlineEdge {
  int view = 0;         ///< index into the views
  double turn = 0;      ///< about the tangent cone, rad
  double off_px = 0;    ///< distance outside the predicted outline, photo pixels
  Eigen::Vector3d ray;  ///< board, unit
};

/// Choice of the outline among edges. `nearest`: a clear edge near the predicted place. `outermost`, for a good guess:
/// the outermost edge with sufficient contrast relative to others. Inside its outline a mirror ball shows its
/// surroundings, in strips of decreasing width.
enum class PickEdge { nearest, outermost };

/// Edges within `reach` (of the radius, 3 pixels at least) of the ball's outline, at most one per direction.
std::vector<OutlineEdge> edges_about(std::span<const BallView> views, const MirrorBall& ball, double reach,
                                     PickEdge pick);

/// Share of the directions around the ball with an edge on its outline, within a pixel or a hundredth of the radius.
/// Edges of weak contrast relative to others nearby do not count. By chance about a quarter.
double share_with_edge(const BallView& view, const MirrorBall& ball);

/// Photo pixels per radian in the directions of a tangent cone.
double pixels_per_rad(const BallView& view, const TangentCone& cone);

}  // namespace burin
