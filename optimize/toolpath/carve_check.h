// burin/optimize/toolpath/carve_check.h - before metal moves: what the files that are to be carved will do to the
// board.
//
// The files themselves are looked at, by replay (burin/optimize/toolpath/toolpath_check.h), not the table they were
// made from; where each stroke comes to lie and how deep it becomes is the bench's word (its machine's map, its depth
// and fields). Errors among the findings are red lines: what would spoil the board. Frame: the board's, mm; the tool's
// places are the machine's.
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

/// What is to be carved, and all that it was made for.
struct CarveCheckInput {
  std::vector<std::filesystem::path> files;  ///< of G-code, in carving order; a frame may be among them
  MachineProfile machine;
  Board board;
  std::optional<Bench> bench{};          ///< measured or believed; without one the machine carves where it is told
  std::optional<Scratches> scratches{};  ///< as designed: the files must carve these, once each
  std::optional<DesignSpec> design{};    ///< whose views the scratches must glint for
  std::optional<HeightMap> heights{};    ///< what the files follow, as in ToolpathOptions
  bool follow_bow = false;
};

/// One file, replayed.
struct CheckedFile {
  std::filesystem::path file;
  std::size_t scratches = 0;  ///< 0: a frame, which stays in the air
  std::size_t lines = 0;
  double duration_s = 0;
  Eigen::Vector2d min_mm{0, 0}, max_mm{0, 0};  ///< places that the tool is sent to
};

/// What the designed views get of the light of the scratches that run for them.
struct ViewReach {
  std::string view, light;
  std::size_t scratches = 0;  ///< that glint for this view more than for another
  double dark = 0;            ///< share of those whose wall is not steep enough: less than half their light is left
};

struct CarveCheck {
  std::vector<Finding> findings;  ///< errors first, then warnings, then notes
  std::vector<CheckedFile> files;
  Scratches carved;                                            ///< as they will lie on the board, in carving order
  std::vector<std::size_t> red;                                ///< rows of `carved` that a red line is about
  std::size_t already_carved = 0;                              ///< of the designed ones: in the metal before
  Eigen::Vector3d tool_min_mm{0, 0, 0}, tool_max_mm{0, 0, 0};  ///< all places that the tool is sent to
  double least_depth_um = 0, most_depth_um = 0;                ///< as the machine is told
  double least_made_um = 0, most_made_um = 0;                  ///< as the grooves become, by what photos measured
  double carve_mm = 0, travel_mm = 0, duration_s = 0;
  std::vector<ViewReach> views;

  /// Whether there is no red line.
  bool good() const { return !has_errors(findings); }
};

/// Looks at everything. Throws Error only for what makes looking impossible: no files, a view or a lamp that the bench
/// does not have; a file that cannot be replayed is a red line.
CarveCheck check_carve(const CarveCheckInput& input);

}  // namespace burin
