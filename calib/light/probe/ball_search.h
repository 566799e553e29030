// burin/calib/light/probe/ball_search.h - where about a ball stands on the board: all places and sizes tried against
// the edges in all views at once. docs/model.md 11.3.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "burin/calib/light/probe/ball_view.h"
#include "burin/calib/light/probe/mirror_ball.h"

namespace burin {

/// Where to look for a ball.
struct BallSearch {
  Eigen::Vector2d board_mm{0, 0};   ///< it stands over the board, from (0, 0) to here
  std::optional<double> radius_mm;  ///< where it is known
  double lift = 0;                  ///< its lowest point is so many radii above the face
};

/// A ball, and how well edges lie along its outline as it should be seen: 1 all around in all views, about 0.3 by
/// chance.
struct FoundBall {
  MirrorBall ball;
  double score = 0;
};

/// Whether a ball would stand before something that a view sees (BallView::free_rays).
bool hides_what_is_seen(std::span<const BallView> views, const MirrorBall& ball);

/// The best few places that differ, best first; none where no view shows the board. Deterministic for any number of
/// threads.
std::vector<FoundBall> search_ball(std::span<const BallView> views, const BallSearch& search);

}  // namespace burin
