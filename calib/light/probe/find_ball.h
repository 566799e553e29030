// burin/calib/light/probe/find_ball.h - finds the mirror ball on a board in all views, or refuses it: search, fit, and
// a test that the object is a ball.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>

#include "burin/base/progress.h"
#include "burin/calib/light/probe/ball_outline.h"
#include "burin/calib/light/probe/ball_view.h"
#include "burin/scene/board.h"

namespace burin {

/// Prior knowledge of a ball and of the photographers.
struct BallHints {
  std::optional<double> ball_mm;   ///< its diameter
  double photographer_rad = 0.44;  ///< half of the cone about each camera in which views differ
};

/// The best-fitting ball, in pictures of any size. Empty if no outline is found. The ball rests on the face. If two
/// views or its diameter determine its height, it may be above the face.
std::optional<FittedBall> find_ball(std::span<const BallView> views, const Board& board, const BallHints& hints,
                                    const Progress& progress = {});

/// Fits from a guess within a twentieth of the radius.
std::optional<FittedBall> fit_ball(std::span<const BallView> views, const MirrorBall& guess, const Board& board,
                                   const BallHints& hints);

/// True if view `v` shows the ball: its outline, or the same room as the others.
bool shows_ball(const FittedBall& ball, std::size_t v);

/// Throws Error for a ball half hidden in all views, not round, or so small that its pixels cover too large an angle.
/// `files`: one photo per view.
void require_ball(const std::optional<FittedBall>& ball, std::span<const std::filesystem::path> files);

}  // namespace burin
