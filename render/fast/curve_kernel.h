// burin/render/fast/curve_kernel.h - the inner loop of tile_kernel.h for light as a curve across a groove
// (burin/render/fast/curve_tables.h). Tiles, pairs and pieces are the same; each piece reads a table in place of
// section 4 of docs/model.md.
#pragma once

#include <cstddef>

#include "burin/render/fast/curve_tables.h"
#include "burin/render/fast/lamp_curves.h"
#include "burin/render/fast/tile_kernel.h"

namespace burin {

/// Kernels of one SIMD width.
struct CurveKernels {
  /// Makes the curves of a tile's runs with pairs. The tile's first pixel is (left, top) of the picture.
  void (*make_curves)(const CurveTables& tables, const TileTask& task, const TilePlaces& places, int left, int top,
                      TileCurves& to);
  /// make_curves() under a lamp, for any cross-section of the grooves.
  void (*make_lamp_curves)(const LampCurves& lamp, const TileTask& task, const TilePlaces& places, std::size_t tile,
                           TileCurves& to);
  /// TileKernels::evaluate for a task with curves.
  void (*evaluate)(const TileTask& task, const TilePlaces& places, TileBuffers& buffers, TilePairs& pairs,
                   const TileJacobian& to);
};

/// Throws Error for a width that this machine does not support.
const CurveKernels& curve_kernels(SimdWidth width);

}  // namespace burin
