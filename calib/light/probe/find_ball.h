// burin/calib/light/probe/find_ball.h - the mirror ball that stands on a board, found in all views or refused: search,
// fit, and whether what was found is a ball.
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

/// What is known of a ball and those who photographed it.
struct BallHints {
  std::optional<double> ball_mm;   ///< its diameter
  double photographer_rad = 0.44;  ///< half of the cone about each camera in which views differ
};

/// The ball that fits best, in pictures of any size. Nothing where no outline is found. It stands on the face, or,
/// where two views or its diameter tell, above it.
std::optional<FittedBall> find_ball(std::span<const BallView> views, const Board& board, const BallHints& hints,
                                    const Progress& progress = {});

/// The same from a guess that is right within a twentieth of the radius.
std::optional<FittedBall> fit_ball(std::span<const BallView> views, const MirrorBall& guess, const Board& board,
                                   const BallHints& hints);

/// Whether view `v` shows the ball: its outline, or the same room as the others.
bool shows_ball(const FittedBall& ball, std::size_t v);

/// Throws Error unless it is a ball: half hidden in all views, not round, or so small that its pixels span too much.
/// `files`: a photo of each view.
void require_ball(const std::optional<FittedBall>& ball, std::span<const std::filesystem::path> files);

}  // namespace burin
