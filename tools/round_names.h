// tools/round_names.h - what the photos of a loop's round are called in the design: names.json, and the round's
// measured bench with the designed names.
#pragma once

#include <filesystem>

#include "tools/match_views.h"
#include "tools/project.h"

namespace burin {

/// `round`/names.json, what a person said of this round's photos; nothing where there is no such file.
///   { "format": "burin/names", "version": 1, "views": { "middle": "v01" }, "lamps": { "ceiling": "lamp" } }
/// Throws Error for a broken one.
GivenNames read_names(const std::filesystem::path& file);
void write_names(const GivenNames& names, const std::filesystem::path& file);

/// The measured bench of a round (round-NN/bench.json) against what that round's board was designed for
/// (round-NN/design.json and the bench that it names, with the tolerance in round-NN/design/design-report.json). A view
/// or lamp that only the project's design.json has by now is taken from the project's own bench.json. `given` goes
/// before names.json. Several measured views near a designed one, each photographed under other lamps, are that one:
/// the nearest stands for it.
Matching match_round(const Project& project, int number, const GivenNames& given = {});

}  // namespace burin
