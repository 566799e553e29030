// tools/loop/stages.h - what a round of a loop project consists of: each stage with what it rests on, how it is made
// (by commands that a person could have typed, and sees) and what it leaves.
//
//   round-NN/design.json          what this round designs for
//   round-NN/bench-before.json    from the second round on: the measured bench of the round before, its views and lamps
//                                 called as the design calls them
//   round-NN/design/              `burin design`: previews, design-report.json
//   round-NN/scratches.csv        as designed
//   round-NN/heights.json         a person's, if the sheet was probed (burin probe): the tool path follows it
//   round-NN/board.gcode, .svg    `burin toolpath`: compensated by the machine's measured map
//   round-NN/sent.csv             the scratches as the machine is told them, in its order
//   round-NN/board.json           the board to be photographed: its scratches are sent.csv
//   round-NN/carve-check.html     `burin check carve`: the page to read before metal moves
//   round-NN/photos/              a person's, of several lamps in a folder each; or, where the project holds a
//                                 truth.json, the simulated camera's
//   round-NN/names.json           which photo's view or lamp is the designed one, where a person had to say so
//   round-NN/session.json         `burin capture`
//   round-NN/calibration/         `burin calibrate`
//   round-NN/refinement/          the same, completed by `burin refine`; its files are copied beside session.json:
//   round-NN/bench.json, ...      the measured bench
//   round-NN/report.html          `burin report`; PROJECT/report.html is the whole loop's ("round" 0)
//   .../made/STAGE.json           what it was made from (tools/loop/record.h)
//
// truth.json stands for the workshop: it is read by `burin simulate` alone, to carve and to photograph.
#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "tools/loop/options.h"
#include "tools/project.h"

namespace burin {

/// A project, and how it is to be made.
struct LoopProject {
  Project project;
  LoopOptions options;
};

/// In their order. The first three are what the metal sees, and stay once there are photos.
enum class StageKind { design, toolpath, board, check, photos, capture, calibrate, refine, report };
inline constexpr StageKind kRoundStages[] = {StageKind::design,    StageKind::toolpath, StageKind::board,
                                             StageKind::check,     StageKind::photos,   StageKind::capture,
                                             StageKind::calibrate, StageKind::refine,   StageKind::report};

/// "design" and "toolpath" as --again and record files call them.
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

/// Where its files lie: the round's folder, or the project's.
std::filesystem::path folder_of(const Project& project, const StageOfRound& at);
std::filesystem::path record_file(const Project& project, const StageOfRound& at);

/// What it would be made from now.
struct StageBasis {
  std::set<std::filesystem::path> files;
  OptionTexts options;
};

/// Throws Error where a file that names others (design.json) cannot be read.
StageBasis basis_of(const LoopProject& loop, const StageOfRound& at);

/// The files of its result that are there now.
std::vector<std::filesystem::path> outputs_of(const LoopProject& loop, const StageOfRound& at);

/// Whether what the next stages need from it is there.
bool has_result(const LoopProject& loop, const StageOfRound& at);

/// Makes it; false if it was stopped before its end (a design, by a signal or --time) and left what it had. Prints the
/// commands.
bool make_stage(const LoopProject& loop, const StageOfRound& at);

/// Takes an interrupted design as it is: the files that the end of its stage would have left.
void finish_design(const LoopProject& loop, int round);

/// A person's photos, or the simulated camera's, lie there, or have been measured: that board is carved.
bool is_photographed(const Project& project, int round);

/// The first round whose board is not photographed; there may be nothing of it yet.
int next_to_carve(const Project& project);

/// require_one_truth() (tools/loop/round_design.h) of that round, where its bench is there.
void require_one_truth_to_carve(const Project& project);

/// The photos of a round, those in its lamps' folders too (tools/loop/round_lamps.h), in the order of their paths.
std::vector<std::filesystem::path> photos_of(const Project& project, int round);

}  // namespace burin
