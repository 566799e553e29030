// burin/calib/light/probe/ball_search.h - searches for a ball on the board coarsely: tries all places and sizes against
// the edges in all views at once. docs/model.md 11.3.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "burin/calib/light/probe/ball_view.h"
#include "burin/calib/light/probe/mirror_ball.h"

namespace burin {

/// Range of the search for a ball.
struct BallSearch {
  Eigen::Vector2d board_mm{0, 0};   ///< it is over the board, from (0, 0) to here
  std::optional<double> radius_mm;  ///< if known
  double lift = 0;                  ///< height of its lowest point above the face, in radii
};

/// A ball, and the match of edges with its predicted outline: 1 all around in all views, about 0.3 by chance.
struct FoundBall {
  MirrorBall ball;
  double score = 0;
};

/// True if the ball would hide something that a view sees (BallView::free_rays).
bool hides_what_is_seen(std::span<const BallView> views, const MirrorBall& ball);

/// The best few distinct places, best first; empty if no view shows the board. Deterministic for any number of threads.
std::vector<FoundBall> search_ball(std::span<const BallView> views, const BallSearch& search);

}  // namespace burin
