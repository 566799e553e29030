// tools/report/section.h - sections of a report. Each section reads one folder and gives pictures, findings and a
// sentence for the top of the page. It is empty (std::nullopt) for a folder without its kind of result.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "burin/base/finding.h"
#include "burin/base/progress.h"

namespace burin {

class JsonObject;

struct Section {
  std::string title;       ///< text: name of the folded section
  std::string outcome;     ///< a sentence or two, HTML: the result
  std::string next{};      ///< HTML, half a sentence: the next step; empty: none
  std::string heading{};   ///< text, above unfolded pictures; empty: none
  std::string pictures{};  ///< HTML: the main pictures
  std::vector<Finding> findings;
  std::string open{};      ///< HTML, below the findings: curves, the bench
  std::string parts{};     ///< HTML: folded() parts, one after the other
  std::string rounds{};    ///< text of a project's rounds.json; empty: none
  bool has_scene = false;  ///< true if `open` holds a bench_section(), which needs its script
};

/// Section of a calibrated (and refined) session: `folder`/session.json (or `session`, if not empty) and
/// `folder`/bench.json. It shows photo and prediction of every view, tags and residuals over the photos, and the
/// parameters with their uncertainties.
std::optional<Section> session_section(const std::filesystem::path& folder, const std::filesystem::path& session,
                                       const Progress& progress);

/// Section of a design, the output of `burin design` in `folder`: target, start and preview of every view, the loss,
/// and the contact sheet.
std::optional<Section> design_section(const std::filesystem::path& folder);

/// Notes and warnings in a design-report.json. Before 0.2.0, "warnings" held both: they are read as warnings.
std::vector<Finding> design_findings(JsonObject& report);

/// Section of a loop project: its rounds side by side with the targets. The newest round's session and design are
/// folded.
std::optional<Section> project_section(const std::filesystem::path& folder, const Progress& progress);

/// Returns the whole content of a section, for a folded part of another one.
std::string whole_section(const Section& section);

/// Returns a project's folder for display on a page: readers anywhere see the page, and "." would be meaningless there.
std::filesystem::path folder_on_page(const std::filesystem::path& folder);

/// Result of write_report().
struct WrittenReport {
  std::string told;  ///< outcome and findings as plain text, one line each
  std::filesystem::path page;
  std::uintmax_t bytes = 0;  ///< of the page, including pictures
};

/// Writes `folder`/report.html with all sections of the folder, after `first` if given. The first section makes the
/// page; the others are folded below it. Throws Error for a folder without any.
WrittenReport write_report(const std::filesystem::path& folder, const std::filesystem::path& session,
                           const std::optional<Section>& first, const Progress& progress);

}  // namespace burin
