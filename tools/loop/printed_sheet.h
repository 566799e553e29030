// tools/loop/printed_sheet.h - checks if the printed sheet (burin sheet) still fits the board to be photographed.
// PROJECT/made/sheet.json holds the sheet's places and the scratches of its photo plan.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tools/wanted_bench.h"

namespace burin {

/// Writes sheet.json after a sheet of that bench was written to these files.
void record_sheet(const Project& project, const WantedBench& wanted, const std::vector<std::filesystem::path>& files);

/// Returns the changes since then, in words: places, or the scratches of the photo plan. Empty without changes, and
/// without a sheet.
std::string changed_since_sheet(const Project& project);

}  // namespace burin
