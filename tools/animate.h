// tools/animate.h - animation of a board for a moving eye or a moving lamp: `burin render --animate`.
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

/// The moving object: the eye along the viewpoints of the views, or the lamp along the places of the lamps.
enum class Moving { eye, lamp };

struct AnimateOptions {
  Moving moving = Moving::eye;
  int frames = 0;      ///< 0: eight per gap between two places, 240 at most
  double seconds = 6;  ///< from the first place to the last; the way back follows
  int pixels = 480;    ///< width and height of a frame
  double exposure =
      /// Factor on radiance. 0: automatic at each place (0.5 % of the lit values clip) and interpolated in between.
      0;
  bool there_and_back = true;
};

/// One interpolated place: index of the place before it, and the share of the way to the next one (0 to 1).
struct Step {
  std::size_t from = 0;
  double share = 0;
  Eigen::Vector3d position_mm{0, 0, 0};
};

/// Returns `frames` steps from the first place to the last. Seen from `center_mm`, directions turn evenly and distances
/// change evenly. A single place gives one step.
std::vector<Step> walk_through(std::span<const Eigen::Vector3d> places_mm, const Eigen::Vector3d& center_mm,
                               int frames);

/// Renders the frames and writes an animated PNG (.png), a film (.mp4, needs ffmpeg) or a folder of numbered PNG files
/// (`out` without extension). `views` and `lights` are the places in order; the other kind stays at its first place.
/// Returns the number of frames, including the way back. Throws Error for fewer than two places to go through, and for
/// .mp4 without ffmpeg.
int animate(const Board& board, const Bench& bench, const Carved& carved, std::span<const View> views,
            std::span<const Light> lights, const std::filesystem::path& out, const AnimateOptions& options,
            const Progress& progress);

}  // namespace burin
