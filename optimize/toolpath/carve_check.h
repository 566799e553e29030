// burin/optimize/toolpath/carve_check.h - pre-flight check: the effect of the files to be carved on the board.
//
// The check replays the files themselves (burin/optimize/toolpath/toolpath_check.h), not the table behind them. The
// bench decides the place and depth of each stroke (its machine's map, its depth and fields). Errors among the findings
// would spoil the board. Frame: the board's, mm; the tool's places are the machine's.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "burin/base/finding.h"
#include "burin/optimize/design_file.h"
#include "burin/optimize/machine_profile.h"
#include "burin/optimize/toolpath/toolpath_plan.h"
#include "burin/scene/bench.h"
#include "burin/scene/board.h"
#include "burin/scene/scratches.h"

namespace burin {

/// The files to be carved, and their inputs.
struct CarveCheckInput {
  std::vector<std::filesystem::path> files;  ///< G-code in carving order; a frame may be among them
  MachineProfile machine;
  Board board;
  std::optional<Bench> bench{};          ///< measured or prior; without one, carved places equal commanded ones
  std::optional<Scratches> scratches{};  ///< as designed: the files must carve these, once each
  std::optional<DesignSpec> design{};    ///< design whose views the scratches must glint for
  std::optional<HeightMap> heights{};    ///< heights followed by the files, as in ToolpathOptions
  bool follow_bow = false;
};

/// One file, replayed.
struct CheckedFile {
  std::filesystem::path file;
  std::size_t scratches = 0;  ///< 0: a frame, above the face throughout
  std::size_t lines = 0;
  double duration_s = 0;
  Eigen::Vector2d min_mm{0, 0}, max_mm{0, 0};  ///< commanded places
};

/// Light of the designed views from their own scratches.
struct ViewReach {
  std::string view, light;
  std::size_t scratches = 0;  ///< number with more glint for this view than for another
  double dark = 0;            ///< share of them with too flat walls: less than half their light remains
};

struct CarveCheck {
  std::vector<Finding> findings;  ///< errors first, then warnings, then notes
  std::vector<CheckedFile> files;
  Scratches carved;                 ///< grooves on the board, in carving order
  std::vector<std::size_t> faulty;  ///< rows of `carved` with an error
  std::size_t already_carved = 0;   ///< number of the designed scratches already in the metal
  Eigen::Vector3d tool_min_mm{0, 0, 0}, tool_max_mm{0, 0, 0};  ///< all commanded places
  double least_depth_um = 0, most_depth_um = 0;                ///< commanded depths
  double least_made_um = 0, most_made_um = 0;                  ///< groove depths by the measured bench
  double carve_mm = 0, travel_mm = 0, duration_s = 0;
  std::vector<ViewReach> views;

  /// True without errors.
  bool good() const { return !has_errors(findings); }
};

/// Checks everything. Throws Error only if a check is impossible: no files, or a view or lamp unknown to the bench. A
/// file without a valid replay is an error finding.
CarveCheck check_carve(const CarveCheckInput& input);

}  // namespace burin
