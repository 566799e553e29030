// tools/plan_words.h - what a plan of photos is given and what it says, in words: the one focus that all its photos
// keep, the exposures of each. For `burin plan` and `burin sheet`.
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

/// Where the lens is focused for all photos, and what is sharp then, mm from the board's middle.
struct PlanFocus {
  double distance_mm = 0;
  FocusRange range;
  bool given = false;  ///< the range was, by a person
};

/// "900-1500mm", "900-1500", "90-150cm", "0.9-1.5m". Throws Error naming --focus-range for anything else.
FocusRange read_focus_range(const std::string& text);

/// The eyes of a design, under their lamps. Throws Error for a view that the bench lacks.
std::vector<DesignedPlace> designed_places(const DesignSpec& design, const Bench& bench);

/// The focus of the designed eyes (their median distance), or else of the bench's views, or else a fifth further than
/// where the lens sees the whole board from straight above; `focus_mm` above 0 and a `range` that is not empty are a
/// person's and go before it. Throws Error for a range that cannot be read, and a focus outside of it.
PlanFocus plan_focus(const Board& board, const Bench& bench, const std::vector<DesignedPlace>& designed,
                     double focus_mm, const std::string& range);

/// "Focus once at 500 mm, at f/8 or smaller: from 452 to 559 mm is sharp. Leave focus and zoom as they are."
std::string focus_in_words(const PlanFocus& focus);

/// What a person should know: designed views that no photo can be taken from, or outside of it, and that no other place
/// was found in it.
std::vector<Finding> focus_findings(const Plan& plan, const PlanFocus& focus);

/// "bracket: the tags' paper at 60 % of white, then -3 stops, -5 stops", and in seconds where the bench was measured.
std::string exposures_in_words(const Plan& plan, const PlannedShot& shot);

/// A bench that was measured knows its exposure too; a nominal one has no scale.
bool is_measured(const Plan& plan);
/// Of the photo that shows paper at 60 % of white, at f/8 and ISO 100; of a measured bench.
double exposure_s(const Plan& plan, const PlannedShot& shot);

/// The plan as the text of a plan.json (docs/file-formats.md).
std::string plan_text(const Plan& plan, const Board& board, const PlanFocus& focus, const std::filesystem::path& file);

}  // namespace burin
