// tools/new/project_files.h - files of a new project: board.json, bench.json in the user's words, design.json,
// targets/, loop.toml. All of them are written, or none.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tools/new/lay_out.h"
#include "tools/new/pictures.h"

namespace burin {

/// Contents of a project.
struct NewProject {
  std::filesystem::path folder;
  std::vector<ChosenPicture> pictures;
  SaidCamera camera;
  LaidOutBench bench;
  std::string machine;  ///< a built-in name, or a file
  int scratches = 0;
  double spent_s = 0;  ///< time spent on reading the pictures; the preview gets the rest of its time limit
};

/// Throws Error for a non-empty folder, and for a file of that name.
void fail_unless_new(const std::filesystem::path& folder);

/// Writes the project next to its new or empty folder first, so that no half-written project remains. The ordinary
/// readers check the files. A quick design of a few seconds (fewer after slow pictures) gives preview.png and
/// scratches.csv, for inspection. preview.png shows each view's picture above its target. Returns each view's PSNR in
/// words. Throws Error if any step fails.
std::string write_project(const NewProject& project);

}  // namespace burin
