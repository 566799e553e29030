// burin/optimize/design/carving_plot.h - what a board shows over the hours to carve it, as a picture.
#pragma once

#include <string>
#include <vector>

#include "burin/optimize/design_result.h"

namespace burin {

/// SVG: PSNR of every view (one name each) and of their mean over the hours. At least one point.
std::string carving_plot(const std::vector<CarvingPoint>& curve, const std::vector<std::string>& view_names);

}  // namespace burin
