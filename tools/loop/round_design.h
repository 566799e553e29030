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

/// Adds "middle=v01" of --view and "ceiling=lamp" of --lamp to the names.json of the round that was measured last.
/// Throws Error for words that are no such pair, and where nothing is measured yet.
void remember_names(const Project& project, const std::vector<std::string>& views,
                    const std::vector<std::string>& lamps);

}  // namespace burin
