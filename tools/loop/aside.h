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
/// is completed when the stage begins again.
std::filesystem::path begin_stage(const LoopProject& loop, const StageOfRound& at, const MadeRecord& begun,
                                  ContentHashes& hashes);

/// Removes files that writing was cut off in: ".NAME.part-PID-..." of processes that are no more, in the project's own
/// folders.
void remove_half_written(const Project& project);

}  // namespace burin
