// burin/calib/light/probe/probe_photos.h - reads the photos of a light probe twice: small, for tags and a first look at
// the ball; then the ball's part at full resolution.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "burin/base/progress.h"
#include "burin/calib/geometry/board_solver.h"
#include "burin/calib/light/probe/ball_view.h"
#include "burin/calib/light/probe/probe_panorama.h"
#include "burin/capture/photo.h"
#include "burin/capture/session.h"
#include "burin/scene/board.h"

namespace burin {

/// Result of the first reading of a bracket.
struct ProbeGlance {
  ViewTags tags;
  Image gray;                          ///< small
  double scale = 1;                    ///< pixels of the photo per pixel of it
  std::vector<Eigen::Vector3d> paper;  ///< R G B of each tag's white paper: value / exposure
};
std::vector<ProbeGlance> glance_at(const Session& session, std::span<const Bracket> brackets,
                                   std::span<const NoiseModel> noise, const Board& board, const Progress& progress);

/// The part of each view that shows the ball. `brackets` and `places` correspond one to one.
std::vector<BallPicture> pictures_of_ball(const Session& session, std::span<const Bracket> brackets,
                                          std::span<const NoiseModel> noise, std::span<const BallView> places,
                                          const MirrorBall& ball, const Progress& progress);

/// The picture in gray, for outlines.
BallView in_gray(const BallPicture& picture);

}  // namespace burin
