// burin/optimize/design/carving_plot.h - plot of a board's quality over its carving time.
#pragma once

#include <string>
#include <vector>

#include "burin/optimize/design_result.h"

namespace burin {

/// SVG with the PSNR of every view (one name each) and of their mean over the hours. Needs at least one point.
std::string carving_plot(const std::vector<CarvingPoint>& curve, const std::vector<std::string>& view_names);

}  // namespace burin
