// burin/optimize/toolpath/drawing.h - a planned path as a drawing, for programs with a tool path generator of their
// own.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

#include "burin/optimize/toolpath/planned_path.h"

namespace burin {

/// Layers for depths, which a drawing lacks. If scratches differ in depth, each depth has a layer named by it.
struct DrawingLayers {
  std::vector<std::string> names;  ///< shallowest first: SCRATCHES if all are equal, else DEPTH_11_5_UM, ...
  std::vector<std::size_t> layer;  ///< of each scratch
};

/// Layers by depth: to 0.1 um, or coarser to have at most 60.
DrawingLayers drawing_layers(const Toolpath& path);

/// SVG 1.1 in mm: width and height in mm, a viewBox in mm, y pointing down for a correct view of the board. Each
/// scratch is a path with one line, which all programs can read. Each layer is a group with a color of its own
/// (Inkscape's layers).
std::string svg(const Toolpath& path, const Eigen::Vector2d& board_size_mm, int decimals = 4);

/// DXF R12 in mm ($INSUNITS 4), a LINE for each scratch on its layer, y up.
std::string dxf(const Toolpath& path, int decimals = 4);

}  // namespace burin
