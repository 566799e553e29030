// burin/optimize/toolpath/drawing.h - a planned path as a drawing, for programs that make their own tool paths.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

#include "burin/optimize/toolpath/planned_path.h"

namespace burin {

/// A drawing has no depths. Where scratches differ in theirs, each depth has a layer, named by it.
struct DrawingLayers {
  std::vector<std::string> names;  ///< shallowest first: SCRATCHES where all are alike, else DEPTH_11_5_UM, ...
  std::vector<std::size_t> layer;  ///< of each scratch
};

/// Layers by depth: to 0.1 um, or coarser where there would be more than 60 of them.
DrawingLayers drawing_layers(const Toolpath& path);

/// SVG 1.1 in mm: width and height in mm, a viewBox in mm, y turned down so that the board is seen as it lies. Each
/// scratch is a path of one line, as all programs read them; each layer is a group of its own color (Inkscape's
/// layers).
std::string svg(const Toolpath& path, const Eigen::Vector2d& board_size_mm, int decimals = 4);

/// DXF R12 in mm ($INSUNITS 4), a LINE for each scratch on its layer, y up.
std::string dxf(const Toolpath& path, int decimals = 4);

}  // namespace burin
