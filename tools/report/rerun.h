// tools/report/rerun.h - whether designing again for the measured bench paid: the board designed for the believed bench
// and the one designed for the measured bench, both looked at under the bench as it is.
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

/// One picture of the two boards: PSNR against its target, each at the exposure that comes nearest.
struct RerunView {
  std::string view;
  double promised_before_db = 0;        ///< of the first design, by the bench that it was made for
  double seen_before_db = 0;            ///< of the first design, under the bench as it is (or in a photo)
  double promised_after_db = 0;         ///< of the second design, by the measured bench
  std::optional<double> seen_after_db;  ///< of the second design, under the bench as it is; nothing if not looked at

  double after_db() const { return seen_after_db.value_or(promised_after_db); }
};

/// Differences below this are hardly seen, in dB.
inline constexpr double kHardlySeen_db = 1;

/// HTML: by how much the views gained, in all and one by one.
std::string rerun_sentence(std::span<const RerunView> views);

/// Why views gained little that regained less than half of what the wrong bench cost them, and what the second design
/// still loses.
std::vector<Finding> rerun_findings(std::span<const RerunView> views);

/// Two folders of `burin design`, the bench under which both are looked at, and the board. What each tool path
/// compensated is read from the design's own report.
struct RerunInput {
  std::filesystem::path before, after, under, board;
};

/// Before and after, side by side with their targets. Throws Error where the two designs do not show the same views.
Section rerun_section(const RerunInput& input, const Progress& progress);

}  // namespace burin
