// tools/watch/wanted_shots.h - wanted photos of a board: the shots of a plan.json, or the views of its design. Frame:
// board, mm.
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "burin/optimize/design_file.h"
#include "burin/scene/bench.h"
#include "burin/scene/board.h"
#include "tools/match_views.h"

namespace burin {

/// Minimum number of places in addition to the design's views, if no plan gives them. A plan has as many
/// (docs/calibration.md).
inline constexpr std::size_t kFewestPlaces = 8;

/// One place for a photo, with its tolerance.
struct WantedShot {
  std::string name;       ///< "p04", or the designed view's
  bool designed = false;  ///< true for a viewpoint of the design
  std::string place;      ///< in words
  Eigen::Vector3d eye_mm{0, 0, 0};
  /// Camera pose, because plans also contain cameras on their side; nothing if the rotation is free.
  std::optional<Eigen::Isometry3d> T_camera_board;
  std::string light, lamp_place;     ///< the lamp's id, and its place in words
  PlaceTolerance tolerance;          ///< a photo within kReach of it (tools/match_views.h) counts as this shot
  std::optional<double> exposure_s;  ///< at f/8 and ISO 100, for the tags' paper at 60 % of white; only from a plan
};

/// Returns the shots of a plan.json, in its order. Throws Error for a missing or broken file, and for another format.
std::vector<WantedShot> planned_shots(const std::filesystem::path& plan, const Board& board);

/// Returns one shot per pair of view and lamp, in the design's order. In color, each of the view's lamps has its own
/// shot. `tolerances`: by match_tolerances(). Throws Error for views missing in `bench`.
std::vector<WantedShot> designed_shots(const DesignSpec& design, const Bench& bench, const Board& board,
                                       const std::vector<MatchTolerance>& tolerances);

/// Gives designed places in a plan the tolerances of their pictures.
void take_tolerances(const std::vector<MatchTolerance>& tolerances, std::vector<WantedShot>& shots);

}  // namespace burin
