// burin/calib/light/probe/ball_outline.h - fits a ball's place and size to its outline in all views: edges to a
// fraction of a pixel, then robust least squares. docs/model.md 11.4. Frame: board, mm.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "burin/calib/light/probe/ball_view.h"
#include "burin/calib/light/probe/mirror_ball.h"

namespace burin {

/// Prior of a ball.
struct BallPrior {
  std::optional<double> radius_mm;  ///< if known, it is fixed
  double lift_sigma_mm = 1;         ///< of the height of its lowest point above the face; the prior's mean is 0
};

/// Quality of a ball's outline in one view.
struct OutlineLook {
  double found = 0;         ///< share of the directions around it with an edge at the predicted place
  double rms_px = 0;        ///< of those edges, photo pixels
  double out_of_round = 0;  ///< amplitude of two or three waves around the outline, relative to the radius
  double radius_px = 0;
};

/// A ball fitted to its outlines.
struct FittedBall {
  MirrorBall ball;
  Eigen::Vector3d center_sigma_mm{0, 0, 0};
  double radius_sigma_mm = 0;
  std::vector<OutlineLook> views;  ///< one per view
  double agreement = 0;            ///< of the views about the room (ball_agreement.h); 0: not computed
};

/// Fits from a guess within a twentieth of the radius. Empty if too few edges are left.
std::optional<FittedBall> fit_ball(std::span<const BallView> views, const MirrorBall& guess, const BallPrior& prior);

}  // namespace burin
