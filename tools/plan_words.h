// tools/plan_words.h - input and output of a photo plan in words: the common focus of all photos and the exposures of
// each. For `burin plan` and `burin sheet`.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "burin/base/finding.h"
#include "burin/calib/plan.h"
#include "burin/optimize/design_file.h"
#include "burin/scene/bench.h"
#include "burin/scene/board.h"

namespace burin {

/// Focus distance of all photos and the range in focus, in mm from the board's center.
struct PlanFocus {
  double distance_mm = 0;
  FocusRange range;
  bool given = false;  ///< true for a range given by the user
};

/// Parses "900-1500mm", "900-1500", "90-150cm" or "0.9-1.5m". Throws Error, naming --focus-range, for other text.
FocusRange read_focus_range(const std::string& text);

/// Returns the eyes of a design with their lamps. Throws Error for a view missing in the bench.
std::vector<DesignedPlace> designed_places(const DesignSpec& design, const Bench& bench);

/// Chooses the focus: the median distance of the designed eyes, or else of the bench's views. Without either it is a
/// fifth more than the distance at which the lens sees the whole board from above. A user's `focus_mm` above 0 or
/// non-empty `range` has priority. Throws Error for an invalid range, and for a focus outside of it.
PlanFocus plan_focus(const Board& board, const Bench& bench, const std::vector<DesignedPlace>& designed,
                     double focus_mm, const std::string& range);

/// Returns the instruction for the common focus, with the aperture and the range in focus, mm.
std::string focus_in_words(const PlanFocus& focus);

/// Reports designed views that no photo can show, focus outside the range, and missing places within it.
std::vector<Finding> focus_findings(const Plan& plan, const PlanFocus& focus);

/// "bracket: the tags' paper at 60 % of white, then -3 stops, -5 stops", with seconds for a measured bench.
std::string exposures_in_words(const Plan& plan, const PlannedShot& shot);

/// Returns true for a measured bench, which has an exposure scale; a nominal one has none.
bool is_measured(const Plan& plan);
/// Exposure time at f/8 and ISO 100 that shows the paper at 60 % of white. For a measured bench only.
double exposure_s(const Plan& plan, const PlannedShot& shot);

/// Returns the text of plan.json (docs/file-formats.md).
std::string plan_text(const Plan& plan, const Board& board, const PlanFocus& focus, const std::filesystem::path& file);

}  // namespace burin
