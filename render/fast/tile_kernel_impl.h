// burin/render/fast/tile_kernel_impl.h - kernels of burin/render/fast/tile_kernel.h over a SIMD vector type, assembled
// from burin/render/fast/kernel/. Only the files compiled for one instruction set each include it (see
// burin/render/fast/packet_math.h).
#pragma once

#include "burin/render/fast/kernel/evaluate.h"
#include "burin/render/fast/kernel/gather.h"
#include "burin/render/fast/kernel/spread.h"
#include "burin/render/fast/tile_kernel.h"
#include "burin/render/fast/tile_raster.h"

namespace burin {

template <class P>
void find_places(const TileTask& task, FoundPlaces& found) {
  using Raster = TileRaster<P>;
  Raster::grow(found.begin, task.most_runs);
  Raster::grow(found.place, task.most_pairs + kTilePixels + 48);
  Raster::find(task.blocks, task.runs, task.shapes, task.run_count, task.valid_rows, found.begin, found.place);
}

template <class P>
constexpr TileKernels tile_kernels_of() {
  return {find_places<P>, kernel::evaluate<P>, kernel::cover<P>, kernel::gather<P>, kernel::spread<P>};
}

}  // namespace burin
