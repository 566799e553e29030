// tools/loop/round_design.h - what one round designs for, and what a person said of its photos' names.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tools/project.h"

namespace burin {

/// Writes a round's design.json: the project's pictures, for the bench as it is known before that round (from the
/// second on bench-before.json, which is written beside it). Throws Error where it is not certain which photo was taken
/// from a designed view, with the candidates and their distances (tools/match_views.h).
void write_round_design(const Project& project, int number, const std::filesystem::path& file);

/// Throws Error where design.json names another board or bench than the project's own: tool path and photos of a loop
/// are made with these.
void require_own_files(const Project& project);

/// Throws Error where design.json and what it names cannot be read, or board.json contradicts the bench that a round is
/// designed for (burin/scene/bench_of_board.h).
void require_one_truth(const Project& project, int number);

/// Throws Error wherever a round's design would be refused for what it is made from: require_one_truth() and, from the
/// second round on, photos of which it is not certain which is which. To be asked before anything is moved.
void require_designable(const Project& project, int number);

/// Adds "middle=v01" of --view and "ceiling=lamp" of --lamp to the names.json of the round that was measured last;
/// "middle=" takes out what was said of it before. Throws Error for words that are no such pair, for names that design
/// or measured bench lack, with those that there are, and where nothing is measured yet.
void remember_names(const Project& project, const std::vector<std::string>& views,
                    const std::vector<std::string>& lamps);

}  // namespace burin
