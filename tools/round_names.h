// tools/round_names.h - designed names for the photos of a loop's round: names.json, and the round's measured bench
// with the designed names.
#pragma once

#include <filesystem>

#include "tools/match_views.h"
#include "tools/project.h"

namespace burin {

/// Read and write `round`/names.json, the user's names for this round's photos. A missing file gives an empty result.
///   { "format": "burin/names", "version": 1, "views": { "middle": "v01" }, "lamps": { "ceiling": "lamp" } }
/// Throws Error for a broken file.
GivenNames read_names(const std::filesystem::path& file);
void write_names(const GivenNames& names, const std::filesystem::path& file);

/// Matches the measured bench of a round (round-NN/bench.json) to the design of that round's board. The design is
/// round-NN/design.json with the bench that it names, and tolerances from round-NN/design/design-report.json. The
/// project's own bench.json supplies views and lamps that only the project's design.json has. `given` has priority over
/// names.json. Several measured views near one designed view, each photographed under other lamps, count as that view;
/// the nearest represents it.
Matching match_round(const Project& project, int number, const GivenNames& given = {});

}  // namespace burin
