// tools/watch/watched_project.h - the board, lens and shots with which a project's photos are compared, and the next
// command.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "tools/watch/shoot.h"

namespace burin {

/// The watched folder and the wanted photos.
struct WatchedProject {
  std::filesystem::path photos;  ///< the folder
  std::filesystem::path keep;    ///< the folder from which `burin loop` takes photos; empty without a round
  Shoot shoot;
  /// Photos of other rounds, by content (photos_of_other_rounds() of tools/loop/round_lamps.h).
  std::map<std::string, std::string> other_rounds;
  /// Lamps of the wanted photos. Each of several lamps has a folder of its name in `photos` and `keep`.
  std::vector<std::string> lamps;
  std::string wanted_from;  ///< "plan/plan.json", "design.json"; empty if nothing defines wanted photos
  std::string plan_line;    ///< the command for a plan, if there is none; else empty
  std::string next;         ///< the command after the photos
};

/// Reads the board of the project's last round, or its own board.json before the first round, and the bench before that
/// round. The shots come from `plan`. If it is empty, they come from plan.json in the round, in the project, or in a
/// folder plan in either, or else from the design's views. `photos`: the folder; empty: the round's own, which is made
/// if missing. Throws Error for a project without a board, a missing folder of photos, and unreadable files. Throws
/// Error for a measured or missing round, unless `photos` is given.
WatchedProject watched_project(const std::filesystem::path& project, const std::filesystem::path& photos,
                               const std::filesystem::path& plan);

}  // namespace burin
