// tools/loop/aside.h - moves replaced results instead of deleting them, because the user may have carved them.
#pragma once

#include <filesystem>
#include <string>

#include "tools/content_hash.h"
#include "tools/loop/record.h"
#include "tools/loop/stages.h"

namespace burin {

/// Begins a stage: writes its record as begun and moves its earlier outputs to round-NN/former/NN-STAGE, with their
/// record as made.json. Returns that folder; empty if there were no outputs. The next begin completes an interrupted
/// move. The page of a refused check is no result and is deleted.
std::filesystem::path begin_stage(const LoopProject& loop, const StageOfRound& at, const MadeRecord& begun,
                                  ContentHashes& hashes);

/// Restores an earlier design or measurement, which take long to make; call it after begin_stage(). A former/ folder
/// qualifies if this version made it from the same contents with the same options, and if it is unchanged. Moves its
/// files back, writes their record, and returns the former folder, which no longer exists. Returns an empty path if
/// none qualifies. `begun`: as written by begin_stage().
std::filesystem::path restore_former(const LoopProject& loop, const StageOfRound& at, const MadeRecord& begun,
                                     ContentHashes& hashes);

/// Removes partial files ".NAME.part-PID-..." of ended processes from the project's own folders.
void remove_half_written(const Project& project);

}  // namespace burin
