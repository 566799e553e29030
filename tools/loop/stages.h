// tools/loop/stages.h - stages of a round of a loop project: inputs, commands and outputs. The commands are ordinary
// ones, printed for the user.
//
//   round-NN/design.json          the round's targets, board and bench
//   round-NN/bench-before.json    from the second round on: the measured bench of the round before, with the design's
//                                 names of views and lamps
//   round-NN/design/              `burin design`: previews, design-report.json
//   round-NN/scratches.csv        as designed
//   round-NN/heights.json         from the user, after probing the sheet (burin probe): the tool path follows it
//   round-NN/board.gcode, .svg    `burin toolpath`: compensated by the machine's measured map
//   round-NN/sent.csv             the commanded scratches, in the machine's order
//   round-NN/board.json           the board to be photographed: its scratches are sent.csv
//   round-NN/carve-check.html     `burin check carve`: the page to read before carving
//   round-NN/photos/              from the user, one folder per lamp if there are several; or from the simulated
//   camera,
//                                 if the project has a truth.json
//   round-NN/names.json           the user's matches of photos' views and lamps to designed ones
//   round-NN/session.json         `burin capture`
//   round-NN/calibration/         `burin calibrate`
//   round-NN/refinement/          the same, completed by `burin refine`; its files are copied next to session.json:
//   round-NN/bench.json, ...      the measured bench
//   round-NN/report.html          `burin report`; PROJECT/report.html is the whole loop's ("round" 0)
//   .../made/STAGE.json           record of inputs and outputs (tools/loop/record.h)
//
// truth.json replaces the workshop. `burin simulate` alone reads it, to carve and to photograph.
#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "tools/loop/options.h"
#include "tools/project.h"

namespace burin {

/// A project and its options.
struct LoopProject {
  Project project;
  LoopOptions options;
};

/// Stages in order. The first three determine the carved board, and stay unchanged after its photos.
enum class StageKind { design, toolpath, board, check, photos, capture, calibrate, refine, report };
inline constexpr StageKind kRoundStages[] = {StageKind::design,    StageKind::toolpath, StageKind::board,
                                             StageKind::check,     StageKind::photos,   StageKind::capture,
                                             StageKind::calibrate, StageKind::refine,   StageKind::report};

/// "design" and "toolpath", as in --again and in record files.
const char* name_of(StageKind stage);

/// One stage of one round; the whole loop's report has round 0.
struct StageOfRound {
  int round = 1;
  StageKind stage = StageKind::design;
  // NOLINTNEXTLINE(modernize-use-nullptr): clang-tidy 14 takes the 0 in what the compiler writes here for a pointer
  auto operator<=>(const StageOfRound&) const = default;
};

/// "round-01/design", or "report" for the whole loop's.
std::string name_of(const Project& project, const StageOfRound& at);

/// Returns the folder of its files: the round's, or the project's.
std::filesystem::path folder_of(const Project& project, const StageOfRound& at);
std::filesystem::path record_file(const Project& project, const StageOfRound& at);

/// Its present inputs and options.
struct StageBasis {
  std::set<std::filesystem::path> files;
  OptionTexts options;
};

/// Throws Error for an unreadable file that names other files (design.json).
StageBasis basis_of(const LoopProject& loop, const StageOfRound& at);

/// Returns the existing files of its result.
std::vector<std::filesystem::path> outputs_of(const LoopProject& loop, const StageOfRound& at);

/// Returns true if the inputs of the next stages exist.
bool has_result(const LoopProject& loop, const StageOfRound& at);

/// Makes the stage and prints its commands. Returns false for a design that a signal or --time ended early with a
/// result.
bool make_stage(const LoopProject& loop, const StageOfRound& at);

/// Accepts an interrupted design: writes the remaining files of its stage.
void finish_design(const LoopProject& loop, int round);

/// Returns true if photos of the user or of the simulated camera exist, or have been measured: that board is carved.
bool is_photographed(const Project& project, int round);

/// Returns the first round without photos of its board; it may not exist yet.
int next_to_carve(const Project& project);

/// Calls require_one_truth() (tools/loop/round_design.h) for that round, if its bench exists.
void require_one_truth_to_carve(const Project& project);

/// Returns the photos of a round, including those in its lamps' folders (tools/loop/round_lamps.h), in the order of
/// their paths.
std::vector<std::filesystem::path> photos_of(const Project& project, int round);

}  // namespace burin
