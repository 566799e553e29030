// tools/report/rerun.h - gain of a second design for the measured bench. It compares the boards designed for the
// nominal and for the measured bench, both under the true bench.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "burin/base/finding.h"
#include "burin/base/progress.h"
#include "tools/report/section.h"

namespace burin {

/// One picture of both boards: PSNR against its target, each at its best exposure.
struct RerunView {
  std::string view;
  double promised_before_db = 0;        ///< first design, predicted with its own bench
  double seen_before_db = 0;            ///< first design, under the true bench (or in a photo)
  double promised_after_db = 0;         ///< second design, predicted with the measured bench
  std::optional<double> seen_after_db;  ///< second design, under the true bench; nothing without an evaluation

  double after_db() const { return seen_after_db.value_or(promised_after_db); }
};

/// Differences below this, in dB, are hardly visible.
inline constexpr double kHardlySeen_db = 1;

/// Returns HTML with the views' gains, overall and one by one.
std::string rerun_sentence(std::span<const RerunView> views);

/// Explains views that regained less than half of their loss from the wrong bench, and the remaining loss of the second
/// design.
std::vector<Finding> rerun_findings(std::span<const RerunView> views);

/// Two output folders of `burin design`, the true bench, and the board. The design's own report has the compensation of
/// its tool path.
struct RerunInput {
  std::filesystem::path before, after, under, board;
};

/// Shows both designs side by side with their targets. Throws Error if the two designs have different views.
Section rerun_section(const RerunInput& input, const Progress& progress);

}  // namespace burin
