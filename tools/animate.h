// tools/animate.h - what one sees of a board while walking by, or while its lamp is carried along: `burin render
// --animate`.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "burin/base/progress.h"
#include "burin/scene/bench.h"
#include "burin/scene/board.h"
#include "burin/scene/carve.h"

namespace burin {

/// What moves: the eye through the places of the views, or the lamp through those of the lamps.
enum class Moving { eye, lamp };

struct AnimateOptions {
  Moving moving = Moving::eye;
  int frames = 0;       ///< 0: eight from one place to the next, 240 at most
  double seconds = 6;   ///< from the first place to the last; then back
  int pixels = 480;     ///< along the picture's sides
  double exposure = 0;  ///< times the radiance; 0: each place's brightest half per cent is white, eased between
  bool there_and_back = true;
};

/// A place on the way from place to place: which two are around it, and how far from the first to the second (0 .. 1).
struct Step {
  std::size_t from = 0;
  double share = 0;
  Eigen::Vector3d position_mm{0, 0, 0};
};

/// `frames` steps from the first place to the last, as seen from `center_mm`: directions turn evenly, distances change
/// evenly. One place alone gives one step.
std::vector<Step> walk_through(std::span<const Eigen::Vector3d> places_mm, const Eigen::Vector3d& center_mm,
                               int frames);

/// Renders the frames and writes them: an animated PNG (.png), a film (.mp4, by ffmpeg if it is installed), or, where
/// `out` has no extension, a folder of numbered PNG files. `views` and `lights` are the places in order; the other kind
/// stands still at its first. Returns the number of
/// frames, those of the way back among them. Throws Error for fewer than two places to go through, and
/// for .mp4 without ffmpeg.
int animate(const Board& board, const Bench& bench, const Carved& carved, std::span<const View> views,
            std::span<const Light> lights, const std::filesystem::path& out, const AnimateOptions& options,
            const Progress& progress);

}  // namespace burin
