// tools/new/project_files.h - a new project as files: board.json, bench.json in a person's words, design.json,
// targets/, loop.toml; all of them or none.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tools/new/lay_out.h"
#include "tools/new/pictures.h"

namespace burin {

/// What a project is made of.
struct NewProject {
  std::filesystem::path folder;
  std::vector<ChosenPicture> pictures;
  SaidCamera camera;
  LaidOutBench bench;
  std::string machine;  ///< a built-in name, or a file
  int scratches = 0;
  double spent_s = 0;  ///< on reading the pictures: the preview takes so much less
};

/// Throws Error for a folder in which something lies already, or whose place is taken by a file.
void fail_unless_new(const std::filesystem::path& folder);

/// Writes the project into its folder, which is made or is empty, beside it first: nothing is left half-written. The
/// files are read back by the ordinary readers. With it a quick design of a few seconds (fewer where the pictures took
/// long): preview.png (the pictures as the views will show them, their targets below), and its scratches as
/// scratches.csv, for looking at. Says each view's PSNR in words. Throws Error where that fails.
std::string write_project(const NewProject& project);

}  // namespace burin
