// burin/optimize/carving/drawing.h - a planned path as a drawing, for programs that make their own tool paths.
#pragma once

#include <Eigen/Core>
#include <string>

#include "burin/optimize/carving/planned_path.h"

namespace burin {

/// SVG 1.1 in mm: width and height in mm, a viewBox in mm, y turned down so that the board is seen as it lies.
std::string svg(const Toolpath& path, const Eigen::Vector2d& board_size_mm, int decimals = 4);

/// DXF R12 in mm ($INSUNITS 4), a LINE for each scratch, y up.
std::string dxf(const Toolpath& path, int decimals = 4);

}  // namespace burin
