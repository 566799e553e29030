// burin/render/fast/curve_kernel.h - the inner loop of burin/render/fast/tile_kernel.h where a groove's light is a
// curve across it (burin/render/fast/curve_tables.h): the same tiles, pairs and pieces, of which each asks a table
// instead of section 4 of docs/model.md.
#pragma once

#include <cstddef>

#include "burin/render/fast/curve_tables.h"
#include "burin/render/fast/lamp_curves.h"
#include "burin/render/fast/tile_kernel.h"

namespace burin {

/// The kernels of one width.
struct CurveKernels {
  /// Makes the curves of those of a tile's runs that have pairs. The tile's first pixel is (left, top) of the picture.
  void (*make_curves)(const CurveTables& tables, const TileTask& task, const TilePlaces& places, int left, int top,
                      TileCurves& to);
  /// The same under a lamp, whatever the grooves' cross-section.
  void (*make_lamp_curves)(const LampCurves& lamp, const TileTask& task, const TilePlaces& places, std::size_t tile,
                           TileCurves& to);
  /// As TileKernels::evaluate, for a task with curves.
  void (*evaluate)(const TileTask& task, const TilePlaces& places, TileBuffers& buffers, TilePairs& pairs,
                   const TileJacobian& to);
};

/// Throws Error for a width that does not run here.
const CurveKernels& curve_kernels(SimdWidth width);

}  // namespace burin
