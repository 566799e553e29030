// tools/loop/round_design.h - design.json of one round, and the user's names for its photos.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tools/project.h"

namespace burin {

/// Writes a round's design.json: the project's pictures, for the bench known before that round. From the second round
/// on, this is bench-before.json, written next to it. If the match between photos and designed views is uncertain,
/// throws Error with candidates and distances (tools/match_views.h).
void write_round_design(const Project& project, int number, const std::filesystem::path& file);

/// Throws Error if design.json names another board or bench than the project's own, which tool path and photos use.
void require_own_files(const Project& project);

/// Throws Error if design.json or its files are unreadable, or if board.json contradicts the bench of the round's
/// design (burin/scene/bench_of_board.h).
void require_one_truth(const Project& project, int number);

/// Throws Error if the inputs of a round's design are invalid: require_one_truth() and, from the second round on,
/// uncertain matches of photos. Call it before any file is moved.
void require_designable(const Project& project, int number);

/// Adds "middle=v01" of --view and "ceiling=lamp" of --lamp to the names.json of the latest measured round; "middle="
/// removes an earlier entry. Throws Error for text that is no such pair, and without a measured round. For a name
/// missing in the design or the measured bench, throws Error with the existing ones.
void remember_names(const Project& project, const std::vector<std::string>& views,
                    const std::vector<std::string>& lamps);

}  // namespace burin
