// tools/report/section.h - the parts of a report. Each looks at a folder and tells its part, with one sentence for the
// top of the page; or says nothing (an empty optional) where the folder holds nothing of its kind.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "burin/render/progress.h"

namespace burin {

struct Section {
  std::string outcome;              ///< one or two sentences, HTML: what came out
  std::vector<std::string> points;  ///< HTML, a sentence or two each: what else to mind
  std::string body;                 ///< HTML
};

/// A calibrated (and refined) session: `folder`/session.json (or `session`, if not empty) and `folder`/bench.json.
/// Photo beside prediction for every view, tags and residuals over the photos, the numbers and how far to trust them.
std::optional<Section> session_section(const std::filesystem::path& folder, const std::filesystem::path& session,
                                       const Progress& progress);

/// A design: what `burin design` left in `folder`. Target, start and preview for every view, the loss, the sheet.
std::optional<Section> design_section(const std::filesystem::path& folder);

/// A loop project: its rounds side by side with the targets.
std::optional<Section> project_section(const std::filesystem::path& folder, const Progress& progress);

/// The page for a folder with any of these, after `first` if there is one, written to `folder`/report.html. Throws
/// Error if it holds none of them. Returns outcome and points as plain text, a line each.
std::string write_report(const std::filesystem::path& folder, const std::filesystem::path& session,
                         const std::optional<Section>& first, const Progress& progress);

}  // namespace burin
