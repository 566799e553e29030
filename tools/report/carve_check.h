// tools/report/carve_check.h - the page to read before metal moves: where the tool goes, what the pictures will be, and
// in red what would spoil the board. The facts are burin/optimize/toolpath/carve_check.h's and the design's own report.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "burin/optimize/toolpath/carve_check.h"

namespace burin {

/// The files that a check is made of. Empty paths: there is none.
struct CarveCheckFiles {
  std::vector<std::filesystem::path> gcode;
  std::filesystem::path board, bench, scratches;
  std::filesystem::path design;   ///< design.json: whose views the scratches must glint for
  std::filesystem::path folder;   ///< that `burin design` filled: previews and design-report.json
  std::filesystem::path heights;  ///< heights.json that the G-code follows
  std::string machine = "grbl";
  bool follow_bow = false;
  std::vector<Finding> outdated;  ///< why the G-code is not of these files any more; empty: it is
};

/// What a check found, for which machine, and the page's pictures (HTML).
struct CheckedCarving {
  CarveCheck check;
  MachineProfile machine;
  std::string pictures;
};

/// The files of a loop's round (round-01): its G-code, scratches.csv, design.json with the board and bench that names,
/// its design folder, and its heights.json if the sheet was probed. Throws Error for a folder that is none.
CarveCheckFiles round_files(const std::filesystem::path& round, const std::string& machine);

/// Reads them and looks at everything (check_carve()).
CheckedCarving check_carve_files(const CarveCheckFiles& files);

/// The views of a design (the folder that `burin design` filled) whose pictures few would recognize: is_unlike()
/// (tools/picture_quality.h). None if there is no report.
std::vector<std::string> unreadable_views(const std::filesystem::path& folder);

/// What the page says, in a few lines for a terminal.
std::string carve_check_text(const CarveCheck& check);

/// The one question to ask before the machine starts: "Sheet clamped, ...?".
std::string carve_question(const CheckedCarving& checked, const CarveCheckFiles& files);

/// Writes the page, self-contained, atomically. Pictures come from `files.folder`, where there is one.
void write_carve_check_page(const CheckedCarving& checked, const CarveCheckFiles& files,
                            const std::filesystem::path& page);

}  // namespace burin
