// tools/watch/wanted_shots.h - the photos that are wanted of a board: those of a plan.json, or the views that its
// design is made for. Frame: board, mm.
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

/// From so many places at least a board is photographed, beside those of its design, where no plan says from which: as
/// many as a plan has (docs/calibration.md).
inline constexpr std::size_t kFewestPlaces = 8;

/// One place to photograph from, and what counts as having stood there.
struct WantedShot {
  std::string name;       ///< "p04", or the designed view's
  bool designed = false;  ///< an eye that the board is made for
  std::string place;      ///< in words
  Eigen::Vector3d eye_mm{0, 0, 0};
  /// Plans also ask for cameras on their side; nothing where it does not matter.
  std::optional<Eigen::Isometry3d> T_camera_board;
  std::string light, lamp_place;     ///< the lamp's id, and where it stands, in words
  PlaceTolerance tolerance;          ///< within kReach of it (tools/match_views.h) a photo is this one
  std::optional<double> exposure_s;  ///< at f/8 and ISO 100, the tags' paper at 60 % of white; where the plan knows
};

/// The shots of a plan.json, in its order. Throws Error for a file that is missing, broken, or no plan.
std::vector<WantedShot> planned_shots(const std::filesystem::path& plan, const Board& board);

/// The views of a design, in its order, one for each pair of view and lamp (in color each of the view's lamps alone);
/// `tolerances` by match_tolerances(). Throws Error for views that `bench` lacks.
std::vector<WantedShot> designed_shots(const DesignSpec& design, const Bench& bench, const Board& board,
                                       const std::vector<MatchTolerance>& tolerances);

/// Designed places tolerate what their pictures tolerate, in a plan as well.
void take_tolerances(const std::vector<MatchTolerance>& tolerances, std::vector<WantedShot>& shots);

}  // namespace burin
