// tools/watch/watched_project.h - what a project's photos are held against: which board, which lens, which shots, and
// what comes when they are there.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "tools/watch/shoot.h"

namespace burin {

/// Where photos are looked for, and what of.
struct WatchedProject {
  std::filesystem::path photos;  ///< the folder
  std::filesystem::path keep;    ///< the folder that `burin loop` takes photos from; empty without a round
  Shoot shoot;
  /// Photos of other rounds, by content (photos_of_other_rounds() of tools/loop/round_lamps.h).
  std::map<std::string, std::string> other_rounds;
  /// The bench's lamps that photos are wanted under: of several, each has a folder of its name in `photos` and `keep`.
  std::vector<std::string> lamps;
  std::string wanted_from;  ///< "plan/plan.json", "design.json"; empty where nothing says which photos are wanted
  std::string plan_line;    ///< the command that plans, where there is no plan; else empty
  std::string next;         ///< the command for when the photos are there
};

/// Reads a project: the board of its last round, or its own board.json before there is one; the bench before that
/// round; the shots of `plan` (or, if that is empty, of a plan.json in the round, the project, or a folder plan in
/// either), or else the design's views. `photos`: the folder; empty for the round's own, which is made if it is not
/// there. Throws Error for a project without a board, a folder of photos that is not there, a round that is measured
/// already or none (unless `photos` is given), and files that cannot be read.
WatchedProject watched_project(const std::filesystem::path& project, const std::filesystem::path& photos,
                               const std::filesystem::path& plan);

}  // namespace burin
