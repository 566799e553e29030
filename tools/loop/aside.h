// tools/loop/aside.h - results that are replaced are moved, never deleted: a person may have carved them.
#pragma once

#include <filesystem>
#include <string>

#include "tools/content_hash.h"
#include "tools/loop/record.h"
#include "tools/loop/stages.h"

namespace burin {

/// Before a stage is made: writes its record as begun, and moves what it left before to round-NN/former/NN-STAGE, with
/// the record of that beside it as made.json. Returns that folder; empty if there was nothing. A move that was cut off
/// is completed when the stage begins again. The page of a check that was refused is no result: it is removed.
std::filesystem::path begin_stage(const LoopProject& loop, const StageOfRound& at, const MadeRecord& begun,
                                  ContentHashes& hashes);

/// Behind begin_stage(), of a design or a measurement (what takes long): where the stage was made before by this
/// version from the same contents with the same options, and a former/ folder still has all of it as it was left then,
/// puts that back, writes its record, and returns the folder that it came from (gone by now); else empty. `begun`: as
/// begin_stage() wrote it.
std::filesystem::path restore_former(const LoopProject& loop, const StageOfRound& at, const MadeRecord& begun,
                                     ContentHashes& hashes);

/// Removes files that writing was cut off in: ".NAME.part-PID-..." of processes that are no more, in the project's own
/// folders.
void remove_half_written(const Project& project);

}  // namespace burin
