// tools/loop/printed_sheet.h - whether the sheet that a person printed (burin sheet) is still that of the board to be
// photographed: PROJECT/made/sheet.json holds its places, and which scratches its photos were planned for.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tools/wanted_bench.h"

namespace burin {

/// Writes it, after the sheet of that bench was made as these files.
void record_sheet(const Project& project, const WantedBench& wanted, const std::vector<std::filesystem::path>& files);

/// What changed since, in words: "the place of view \"d0\"", "the scratches, for which its photos were planned". Empty
/// where nothing did, or no sheet was made.
std::string changed_since_sheet(const Project& project);

}  // namespace burin
