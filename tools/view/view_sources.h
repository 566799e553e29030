// tools/view/view_sources.h - what there is to see of a project, or of a board's files: gathered for the viewer's page.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "burin/base/finding.h"
#include "burin/base/progress.h"
#include "tools/view/board_view.h"

namespace burin {

/// A loop project (docs/file-formats.md): the newest round that was measured, as it was believed and as it is, and the
/// round designed after it; or, before anything was measured, the newest design; or a first design that lies in the
/// project without a round (in `design`, in `preview`, or named by board.json: what `burin new` left is called a
/// preview). `findings` gets what the person should know. Throws Error for a folder that is no project, and where
/// nothing is designed yet, with what to do.
BoardView view_of_project(const std::filesystem::path& folder, std::vector<Finding>& findings);

/// Files of a board. `design` may be empty: then all views of the bench are looked from, under its first lamp.
struct ViewFiles {
  std::filesystem::path board, bench, scratches, design;
  bool as_sent = false;  ///< the scratches are what the machine was told, not where grooves are wanted
};
BoardView view_of_files(const ViewFiles& files, std::vector<Finding>& findings);

}  // namespace burin
