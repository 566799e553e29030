// tools/wanted_bench.h - a project's design with its present bench: the latest measured one, or else the nominal one.
// It is the basis of viewpoints and photo lists for the user.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "burin/optimize/design_file.h"
#include "burin/scene/bench.h"
#include "burin/scene/board.h"
#include "tools/match_views.h"
#include "tools/project.h"

namespace burin {

struct WantedBench {
  DesignSpec design;
  Board board;
  Bench bench;  ///< with the design's names of views and lamps
  std::filesystem::path board_file, bench_file;
  /// Scratches of the present or next carved board; empty without a design.
  std::filesystem::path scratches;
  int measured_rounds = 0;                 ///< number of rounds that measured it; 0: nominal
  std::vector<MatchTolerance> tolerances;  ///< one per view of the design, by shown_tolerances()
};

/// Reads PROJECT/design.json, the files that it names, and the rounds. Throws Error for a folder without design.json,
/// and for an undecided match between measured and designed views (require_complete()).
WantedBench wanted_bench(const Project& project);

/// Returns the eyes of the design's views, in its order, board frame, mm. Throws Error for a view missing in the bench.
std::vector<Eigen::Vector3d> designed_eyes(const WantedBench& wanted);

}  // namespace burin
