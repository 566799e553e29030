// tools/report/carve_check_files.h - the files that the check before carving reads (tools/report/carve_check.h).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "burin/base/finding.h"

namespace burin {

/// Input files of a check. An empty path: no such file.
struct CarveCheckFiles {
  std::vector<std::filesystem::path> gcode;
  std::filesystem::path board, bench, scratches;
  std::filesystem::path design;   ///< design.json: for its views the scratches must glint
  std::filesystem::path folder;   ///< output of `burin design`: previews and design-report.json
  std::filesystem::path heights;  ///< heights.json for the depths in the G-code
  std::string machine = "grbl";
  bool follow_bow = false;
  std::vector<Finding> outdated;  ///< reasons for outdated G-code; empty: up to date
};

}  // namespace burin
