// tools/wanted_bench.h - a project's design with the bench that it is for now: the one that the latest round measured,
// or else the nominal one. For what a person takes to the wall: where to stand and which photos to take.
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
  Bench bench;  ///< views and lamps called as the design calls them
  std::filesystem::path board_file, bench_file;
  std::filesystem::path
      scratches;            ///< of the board on which they are or will be carved; empty if none are designed yet
  int measured_rounds = 0;  ///< how many rounds have measured it; 0: it is nominal
  std::vector<MatchTolerance> tolerances;  ///< one a view of the design, by shown_tolerances()
};

/// Reads PROJECT/design.json and what it names, and the rounds there are. Throws Error for a folder without a
/// design.json, and where it is not decided which measured view is which designed one (require_complete()).
WantedBench wanted_bench(const Project& project);

/// The eyes of the design's views, in its order, board frame, mm. Throws Error for a view that the bench lacks.
std::vector<Eigen::Vector3d> designed_eyes(const WantedBench& wanted);

}  // namespace burin
