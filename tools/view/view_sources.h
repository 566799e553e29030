// tools/view/view_sources.h - collects the viewer's contents from a project, or from a board's files.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "burin/base/finding.h"
#include "burin/base/progress.h"
#include "tools/view/board_view.h"

namespace burin {

/// Reads a loop project (docs/file-formats.md). The contents are the latest measured round, with its nominal and
/// measured bench, and the round designed after it. Without a measurement they are the latest design. Without a round
/// they are a design in the project itself: in `design`, in `preview`, or named by board.json. The output of `burin
/// new` is called a preview. Adds notes to `findings`. Throws Error, with a remedy, for a folder that is no project,
/// and for a project without a design.
BoardView view_of_project(const std::filesystem::path& folder, std::vector<Finding>& findings);

/// Files of a board. With an empty `design`, the page has all views of the bench, under its first lamp.
struct ViewFiles {
  std::filesystem::path board, bench, scratches, design;
  bool as_sent = false;  ///< the scratches are commanded ones, not the intended grooves
};
BoardView view_of_files(const ViewFiles& files, std::vector<Finding>& findings);

}  // namespace burin
