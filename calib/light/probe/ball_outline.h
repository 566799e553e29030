// burin/calib/light/probe/ball_outline.h - a ball's place and size from its outline in all views: edges to a fraction
// of a pixel, then robust least squares. docs/model.md 11.4. Frame: board, mm.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "burin/calib/light/probe/ball_view.h"
#include "burin/calib/light/probe/mirror_ball.h"

namespace burin {

/// What is believed of a ball before it is measured.
struct BallPrior {
  std::optional<double> radius_mm;  ///< then it is that
  double lift_sigma_mm = 1;         ///< of the height of its lowest point above the face, which is believed to be 0
};

/// How a ball's outline looks in one view.
struct OutlineLook {
  double found = 0;         ///< share of the directions around it in which an edge lies where the ball says
  double rms_px = 0;        ///< of those edges, photo pixels
  double out_of_round = 0;  ///< amplitude of what has two or three waves around, of the radius
  double radius_px = 0;
};

/// A ball, as its outlines have it.
struct FittedBall {
  MirrorBall ball;
  Eigen::Vector3d center_sigma_mm{0, 0, 0};
  double radius_sigma_mm = 0;
  std::vector<OutlineLook> views;  ///< one a view
  double agreement = 0;            ///< of what the views show in it (ball_agreement.h); 0: not looked at
};

/// From a guess that is right within a twentieth of the radius. Nothing where too few edges are left to fit to.
std::optional<FittedBall> fit_ball(std::span<const BallView> views, const MirrorBall& guess, const BallPrior& prior);

}  // namespace burin
