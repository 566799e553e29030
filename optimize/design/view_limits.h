// burin/optimize/design/view_limits.h - limits of a design's views: the same grooves rendered without one effect at a
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

/// Gain of a view in dB if one effect were absent and all else equal.
struct ViewLimits {
  double crossings = 0;  ///< grooves with the same loss at crossings, spread evenly along them
  double crosstalk = 0;  ///< no light from the grooves made for other views
  double face = 0;       ///< a black plain face
  double cutoff = 0;     ///< walls steep enough for the whole lobe
  double pixels = 0;     ///< of the figure of merit for eyes: a target without detail beyond the design's pixels
};

/// Limits of one view's channels, which must be rendered with `grooves`; `pixels` is left out.
ViewLimits limits_of(std::span<WorkView> channels, const std::vector<double>& log_exposure, const LyingGrooves& grooves,
                     const Bench& bench, const Board& board);

/// ViewLimits::pixels of a view on finer pixels than its design's; `coarse` is the design's target.
double pixels_limit_db(std::span<const WorkView> channels, const std::vector<double>& log_exposure,
                       const Image& coarse);

/// The largest limit of a view, and a remedy. `more_fit`: the design did not reduce the number of scratches.
Finding limits_in_words(const std::string& view, double psnr_db, const ViewLimits& limits, bool more_fit);

}  // namespace burin
