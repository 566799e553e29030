// burin/optimize/design/view_limits.h - what limits a design's views: the same grooves rendered without one thing at a
// time. docs/design.md, 'What limits a picture'.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "burin/base/finding.h"
#include "burin/base/image.h"
#include "burin/optimize/design/design_views.h"
#include "burin/scene/bench.h"
#include "burin/scene/board.h"

namespace burin {

/// By how much a view would come closer to its target, dB, if one thing that limits it were gone and all else the same.
struct ViewLimits {
  double crossings = 0;  ///< grooves were cut evenly along them, as much as they are
  double crosstalk = 0;  ///< the grooves made for other views did not show
  double face = 0;       ///< the plain face were black
  double cutoff = 0;     ///< walls were steep enough for all of the light that they could send
  double pixels = 0;     ///< of the figure for eyes: the target had no more detail than the design's pixels
};

/// Of one view's channels, which must be as rendered with `grooves`; all but the pixels.
ViewLimits limits_of(std::span<WorkView> channels, const std::vector<double>& log_exposure, const LyingGrooves& grooves,
                     const Bench& bench, const Board& board);

/// ViewLimits::pixels of a view on finer pixels than its design's, whose target is `coarse`.
double pixels_limit_db(std::span<const WorkView> channels, const std::vector<double>& log_exposure,
                       const Image& coarse);

/// What limits a view most, and what would lift it.
Finding limits_in_words(const std::string& view, double psnr_db, const ViewLimits& limits);

}  // namespace burin
