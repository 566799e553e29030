// tools/report/section.h - the parts of a report. Each looks at a folder and tells its part, with one sentence for the
// top of the page; or says nothing (an empty optional) where the folder holds nothing of its kind.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "burin/base/finding.h"
#include "burin/base/progress.h"

namespace burin {

struct Section {
  std::string title;              ///< text: what it is called where it is folded
  std::string outcome;            ///< a sentence or two, HTML: what came out
  std::string next{};             ///< HTML, half a sentence: what to do next; empty where nothing follows from it
  std::string heading{};          ///< text, above the pictures where they stand open; empty: none
  std::string pictures{};         ///< HTML: what is looked at first
  std::vector<Finding> findings;  ///< what to mind
  std::string open{};             ///< HTML, below what to mind: curves, the bench
  std::string parts{};            ///< HTML: folded() parts, one after the other
  std::string rounds{};           ///< of a project, rounds.json's text; empty: none
  bool has_scene = false;         ///< whether `open` holds a bench_section(), which needs its script
};

/// A calibrated (and refined) session: `folder`/session.json (or `session`, if not empty) and `folder`/bench.json.
/// Photo beside prediction for every view, tags and residuals over the photos, the numbers and how far to trust them.
std::optional<Section> session_section(const std::filesystem::path& folder, const std::filesystem::path& session,
                                       const Progress& progress);

/// A design: what `burin design` left in `folder`. Target, start and preview for every view, the loss, the sheet.
std::optional<Section> design_section(const std::filesystem::path& folder);

/// A loop project: its rounds side by side with the targets, and the newest round's session and design, folded.
std::optional<Section> project_section(const std::filesystem::path& folder, const Progress& progress);

/// All that a section shows, as it stands inside a folded part of another.
std::string whole_section(const Section& section);

/// A project's folder as a page names it: a page is read from anywhere, and "." would say nothing there.
std::filesystem::path folder_on_page(const std::filesystem::path& folder);

/// What write_report() made.
struct WrittenReport {
  std::string told;  ///< outcome and findings as plain text, a line each
  std::filesystem::path page;
  std::uintmax_t bytes = 0;  ///< of the page, pictures included
};

/// The page for a folder with any of these, after `first` if there is one, written to `folder`/report.html: the first
/// that there is makes the page, the others are folded below it. Throws Error if the folder holds none of them.
WrittenReport write_report(const std::filesystem::path& folder, const std::filesystem::path& session,
                           const std::optional<Section>& first, const Progress& progress);

}  // namespace burin
