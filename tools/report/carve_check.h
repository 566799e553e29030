// tools/report/carve_check.h - page to read before carving: the tool's path, the predicted pictures, and problems as
// errors. Its facts come from burin/optimize/toolpath/carve_check.h and from the design's own report.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "burin/optimize/toolpath/carve_check.h"
#include "tools/report/carve_check_files.h"

namespace burin {

/// Findings of a check, the machine, and the page's pictures (HTML).
struct CheckedCarving {
  CarveCheck check;
  MachineProfile machine;
  std::string pictures;
};

/// Returns the files of a loop's round (round-01): G-code, scratches.csv, design.json with its board and bench, and the
/// design folder. Includes heights.json of a probed sheet. Throws Error for any other folder.
CarveCheckFiles round_files(const std::filesystem::path& round, const std::string& machine);

/// Reads the files and runs check_carve().
CheckedCarving check_carve_files(const CarveCheckFiles& files);

/// Returns the views of a design (a folder from `burin design`) with hard to recognize pictures: is_unlike()
/// (tools/picture_quality.h). Returns none without a report.
std::vector<std::string> unreadable_views(const std::filesystem::path& folder);

/// Returns a short form of the page for a terminal.
std::string carve_check_text(const CarveCheck& check);

/// Returns the one question before the machine starts: "Is the sheet clamped, ...?".
std::string carve_question(const CheckedCarving& checked, const CarveCheckFiles& files);

/// Writes the page, self-contained and atomically. Pictures come from `files.folder`, if there is one.
void write_carve_check_page(const CheckedCarving& checked, const CarveCheckFiles& files,
                            const std::filesystem::path& page);

}  // namespace burin
